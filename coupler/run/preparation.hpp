#pragma once
// What comes before the first step: packing and stiffness (cached by hash), and everything the engines are told.

#include <filesystem>
#include <functional>
#include <string>

#include "coupler/run/assembly.hpp"
#include "coupler/run/engine_link.hpp"

namespace gabion::coupler {

using Log = std::function<void(const std::string&)>;

/// Files that spare a run what an earlier one has computed. Each is one protocol payload with a checksum;
/// a damaged file is ignored and replaced.
class Cache {
 public:
  /// Folder: GABION_CACHE, else XDG_CACHE_HOME/gabion, else ~/.cache/gabion.
  Cache();
  std::filesystem::path file(const std::string& kind, std::uint64_t key) const;

 private:
  std::filesystem::path folder_;
};

/// The ground's packing: a lattice, or a random packing made by dem_server unless cached.
Packing obtain_packing(const scene::Scene& scene, EngineLink* dem, const Cache& cache, const Log& log);

/// The ground's elastic constants: as the scene gives them, or measured on the packing by dem_server unless cached.
Elasticity obtain_elasticity(const scene::Scene& scene, const Packing& packing, EngineLink* dem, const Cache& cache,
                             const Log& log);

/// Everything but faces and ties; returns masses and stable step. Fills in assembly.grains.plain_mass and assembly.clump.
protocol::Ready configure_dem(const scene::Scene& scene, Assembly& assembly, EngineLink& dem, const Log& log);
protocol::Ready configure_continuum(const scene::Scene& scene, const Assembly& assembly, EngineLink& continuum);

/// Puts the scene's initial motion and wave packet into velocity (at -dt/2) and displacement of both engines.
void start_motion(const scene::Scene& scene, const Assembly& assembly, double dt, EngineLink* dem, EngineLink* continuum);

/// Edge-to-edge: each grain at the border feels the gravity of its part on the grains' side, whatever its weight.
void trim_gravity(const scene::Scene& scene, const Assembly& assembly, const std::vector<double>& grain_weights, EngineLink& dem);

}  // namespace gabion::coupler
