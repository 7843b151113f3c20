#pragma once
// What holds or drives the faces of the ground, told to both engines as groups, loads and dashpots.

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "coupler/ground/surface.hpp"
#include "coupler/interface/multipliers.hpp"
#include "coupler/run/assembly.hpp"
#include "coupler/run/engine_link.hpp"

namespace gabion::coupler {

/// One engine's share of the faces.
class FaceSide {
 public:
  /// link may be null: the medium is absent.
  FaceSide(EngineLink* link, std::size_t points) : link_(link), freedom_(points, Triple{1, 1, 1}), viscosity_(points) {}

  /// Replaces the condition of a face. held: entities a plate would hold; patch: areas. Where the face was held
  /// before and now absorbs, the reactions of the last step stay on as dead loads.
  void apply(int face, const scene::Face& condition, const std::vector<std::int32_t>& held, const Patch& patch,
             const Elasticity& elasticity);

  /// m + c dt/2 and freedom of every point, for the multipliers.
  Inertia inertia(const std::vector<double>& mass, double dt) const;

 private:
  void keep_reactions(int face, const std::vector<std::int32_t>& held);

  EngineLink* link_;
  struct State {
    std::vector<std::int32_t> held;
    std::uint8_t components = 0;
    std::vector<std::int32_t> absorbing;
    std::vector<Triple> coefficients;
    bool loaded = false;
  };
  std::array<State, 6> faces_;
  std::vector<Triple> freedom_, viscosity_;
};

/// Both sides, with the areas and groups worked out once.
class Faces {
 public:
  Faces(const scene::Scene& scene, const Assembly& assembly, EngineLink* dem, EngineLink* continuum);
  void apply(int face, const scene::Face& condition);
  Inertia grain_inertia(const std::vector<double>& mass, double dt) const { return grains_.inertia(mass, dt); }
  Inertia node_inertia(const std::vector<double>& mass, double dt) const { return nodes_.inertia(mass, dt); }

 private:
  const Assembly& assembly_;
  FaceSide grains_, nodes_;
  std::array<std::vector<std::int32_t>, 6> held_grains_, held_nodes_;
  std::array<Patch, 6> grain_patches_, node_patches_;
};

extern const std::array<const char*, 6> face_names;

}  // namespace gabion::coupler
