#pragma once
// What comes before the first step: packing and stiffness (cached by hash), and everything the engines are told.

#include <filesystem>
#include <functional>
#include <string>

#include "coupler/run/assembly.hpp"
#include "coupler/run/cache.hpp"
#include "coupler/run/engine_link.hpp"

namespace gabion::coupler {

using Log = std::function<void(const std::string&)>;

/// The ground's packing: a lattice, or a random packing made by dem_server unless cached.
Packing obtain_packing(const scene::Scene& scene, EngineLink* dem, const Cache& cache, const Log& log);

/// The ground's elastic constants: as the scene gives them, or measured on the packing by dem_server unless cached.
Elasticity obtain_elasticity(const scene::Scene& scene, const Packing& packing, EngineLink* dem, const Cache& cache,
                             const Log& log);

/// The packing with elastic bonds and no weight, for measurements.
void tell_bonded_packing(const scene::Scene& scene, const Packing& packing, EngineLink& dem);

/// How far inside each face a continuum would have to be held, m, measured by dem_server unless cached; 0 where nothing
/// holds the face's normal, where no mesh stands for the grains there, or the scene wants it so.
std::array<double, 6> obtain_face_offsets(const scene::Scene& scene, const Packing& packing, EngineLink* dem, const Cache& cache,
                                          const Log& log);

/// Everything but faces and ties; returns masses and stable step. Fills in assembly.grains.plain_mass and assembly.clump.
protocol::Ready configure_dem(const scene::Scene& scene, Assembly& assembly, EngineLink& dem, const Log& log);
protocol::Ready configure_continuum(const scene::Scene& scene, const Assembly& assembly, EngineLink& continuum);

/// Puts the scene's initial motion and wave packet into velocity (half a step before the start) and displacement of both
/// engines. node_rate: step of a node over dt.
void start_motion(const scene::Scene& scene, const Assembly& assembly, double dt, EngineLink* dem, EngineLink* continuum,
                  const std::function<double(std::size_t)>& node_rate);

/// Edge-to-edge: each grain at the border feels the gravity of its part on the grains' side, whatever its weight.
void trim_gravity(const scene::Scene& scene, const Assembly& assembly, const std::vector<double>& grain_weights, EngineLink& dem);

}  // namespace gabion::coupler
