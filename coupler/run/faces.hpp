#pragma once
// What holds or drives the faces of the ground, told to both engines as groups, loads and dashpots.

#include <array>
#include <cstdint>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "coupler/ground/surface.hpp"
#include "coupler/interface/multipliers.hpp"
#include "coupler/run/assembly.hpp"
#include "coupler/run/engine_link.hpp"

namespace gabion::coupler {

/// What a face's condition holds: the plate's points, and for a seat the two that stop drift and turning.
struct Hold {
  std::string name;
  std::vector<std::int32_t> entities;
  std::uint8_t components = 0;  ///< bit per axis
};

/// Points of a seat: the one nearest to the face's middle is held along both tangents, the one farthest from it along
/// the first tangent only across. Statically determinate: at rest it carries no force under balanced loads. -1: none.
struct SeatPoints {
  std::int32_t middle = -1, across = -1;
};
SeatPoints seat_points(int face, const std::vector<std::int32_t>& held, const std::vector<Point>& position, const scene::Box& ground);

/// Bits x = 1, y = 2, z = 4 that a condition holds on its face, of grains or of nodes.
std::uint8_t held_components(int face, const scene::Face& condition, bool grains);

/// One engine's share of the faces.
class FaceSide {
 public:
  /// link may be null: the medium is absent. grains: this is the grains' side, else the mesh's.
  FaceSide(EngineLink* link, std::size_t points, const scene::Box& ground, bool grains)
      : link_(link), ground_(ground), grains_(grains), freedom_(points, Triple{1, 1, 1}), viscosity_(points) {}

  /// Replaces the condition of a face. held: entities a plate would hold; patch: areas. Where the face was held
  /// before and now absorbs, the reactions of the last step stay on as dead loads.
  void apply(int face, const scene::Face& condition, const std::vector<std::int32_t>& held, const SeatPoints& seat,
             const Patch& patch, const Elasticity& elasticity);

  /// m + c dt/2 and freedom of every point, for the multipliers.
  Inertia inertia(const std::vector<double>& mass, double dt) const;

  /// For checkpoints: the reactions that became dead loads.
  nlohmann::json dead_loads() const;
  void tell_dead_loads(const nlohmann::json& loads);

 private:
  void hold(int face, const scene::Face& condition, std::vector<Hold> holds);
  void keep_reactions(const Hold& hold);
  void set_wall(int face, const scene::Face& condition);

  EngineLink* link_;
  scene::Box ground_;
  bool grains_;
  std::array<std::optional<double>, 6> walls_;  ///< friction of the wall on each face
  struct State {
    std::vector<Hold> holds;
    std::vector<std::int32_t> absorbing;
    std::vector<Triple> coefficients;
    bool loaded = false;
  };
  std::array<State, 6> faces_;
  std::vector<Triple> freedom_, viscosity_;
  std::map<std::string, protocol::Loads> dead_;
};

/// Both sides, with the areas and groups worked out once.
class Faces {
 public:
  Faces(const scene::Scene& scene, const Assembly& assembly, EngineLink* dem, EngineLink* continuum);
  void apply(int face, const scene::Face& condition);
  Inertia grain_inertia(const std::vector<double>& mass, double dt) const { return grains_.inertia(mass, dt); }
  nlohmann::json dead_loads() const { return {{"grains", grains_.dead_loads()}, {"nodes", nodes_.dead_loads()}}; }
  void tell_dead_loads(const nlohmann::json& loads) {
    grains_.tell_dead_loads(loads.at("grains"));
    nodes_.tell_dead_loads(loads.at("nodes"));
  }
  Inertia node_inertia(const std::vector<double>& mass, double dt) const { return nodes_.inertia(mass, dt); }

 private:
  const Assembly& assembly_;
  FaceSide grains_, nodes_;
  std::array<std::vector<std::int32_t>, 6> held_grains_, held_nodes_;
  std::array<SeatPoints, 6> seat_grains_, seat_nodes_;  ///< in one medium only
  std::array<Patch, 6> grain_patches_, node_patches_;
};

extern const std::array<const char*, 6> face_names;

}  // namespace gabion::coupler
