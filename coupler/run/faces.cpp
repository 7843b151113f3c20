#include "coupler/run/faces.hpp"

#include <algorithm>
#include <cmath>

namespace gabion::coupler {

const std::array<const char*, 6> face_names{"xmin", "xmax", "ymin", "ymax", "zmin", "zmax"};

namespace {

std::uint8_t bit(int axis) { return static_cast<std::uint8_t>(1 << axis); }

/// The two directions along a face.
std::array<int, 2> tangents(int face) { return {(face / 2 + 1) % 3, (face / 2 + 2) % 3}; }

std::vector<Hold> holds_of(int face, const scene::Face& condition, const std::vector<std::int32_t>& held, const SeatPoints& seat,
                           bool grains) {
  std::vector<Hold> holds;
  const std::string name = face_names[face];
  if (const std::uint8_t components = held_components(face, condition, grains)) holds.push_back({name, held, components});
  if (condition.kind != "seat" || seat.middle < 0) return holds;
  const auto [first, second] = tangents(face);
  holds.push_back({name + ".seat", {seat.middle}, static_cast<std::uint8_t>(bit(first) | bit(second))});
  holds.push_back({name + ".across", {seat.across}, bit(second)});
  return holds;
}

void put_triple(std::vector<double>& out, double x, double y, double z) { out.insert(out.end(), {x, y, z}); }

}  // namespace

std::uint8_t held_components(int face, const scene::Face& condition, bool grains) {
  if (condition.kind == "fixed" || (condition.kind == "wall" && !grains)) return 7;
  if (condition.kind == "roller" || condition.kind == "seat") return bit(face / 2);
  std::uint8_t bits = 0;
  if (condition.kind == "velocity")
    for (int axis = 0; axis < 3; ++axis)
      if (condition.direction[axis] != 0.0) bits |= bit(axis);
  return bits;
}

SeatPoints seat_points(int face, const std::vector<std::int32_t>& held, const std::vector<Point>& position, const scene::Box& ground) {
  const auto [first, second] = tangents(face);
  const auto nearest = [&](double at_first, double at_second) {
    std::int32_t best = -1;
    double least = scene::infinity;
    for (const std::int32_t e : held) {
      const Point& x = position[static_cast<std::size_t>(e)];
      const double square = std::pow(x[first] - at_first, 2) + std::pow(x[second] - at_second, 2);
      if (square < least) least = square, best = e;
    }
    return best;
  };
  SeatPoints seat;
  seat.middle = nearest(0.5 * (ground.lo[first] + ground.hi[first]), 0.5 * (ground.lo[second] + ground.hi[second]));
  if (seat.middle < 0) return seat;
  seat.across = nearest(ground.hi[first], position[static_cast<std::size_t>(seat.middle)][second]);
  return seat.across == seat.middle ? SeatPoints{} : seat;
}

/// Tells the engine the groups that hold the face now, and empties those that no longer do.
void FaceSide::hold(int face, const scene::Face& condition, std::vector<Hold> holds) {
  State& state = faces_[face];
  std::vector<Hold> told = holds;
  for (const Hold& before : state.holds) {
    const auto same = [&](const Hold& now) { return now.name == before.name; };
    if (std::none_of(holds.begin(), holds.end(), same)) told.push_back({before.name, {}, 0});
  }
  for (const Hold& h : told) {
    protocol::Constrain group;
    group.name = h.name;
    group.entities = h.entities;
    group.components = h.components;
    const bool moves = condition.kind == "velocity";
    group.direction = std::vector<double>(condition.direction.begin(), condition.direction.end());
    group.history_kind = moves ? condition.history.kind : "zero";
    if (moves) group.history = condition.history.parameters;
    link_->tell(group);
  }
  state.holds = std::move(holds);
}

void FaceSide::apply(int face, const scene::Face& condition, const std::vector<std::int32_t>& held, const SeatPoints& seat,
                     const Patch& patch, const Elasticity& elasticity) {
  if (!link_) return;
  State& state = faces_[face];
  const std::string name = face_names[face];
  const int normal = face / 2;
  if (condition.kind == "absorbing")
    for (const Hold& h : state.holds) keep_reactions(h);
  hold(face, condition, holds_of(face, condition, held, seat, grains_));
  if (grains_) set_wall(face, condition);

  const bool loaded = condition.kind == "pressure" || condition.kind == "traction";
  if (loaded || state.loaded) {
    protocol::Loads loads;
    loads.name = name;
    loads.history_kind = loaded ? condition.history.kind : "zero";
    if (loaded) {
      loads.history = condition.history.parameters;
      loads.entities = patch.entities;
      std::vector<double> vectors;
      Triple direction = condition.direction;
      if (condition.kind == "pressure") {
        direction = {};
        direction[normal] = face % 2 == 0 ? 1.0 : -1.0;  // compression pushes inward
      }
      for (const double a : patch.area) put_triple(vectors, a * direction[0], a * direction[1], a * direction[2]);
      loads.vectors = vectors;
    }
    link_->tell(loads);
    state.loaded = loaded;
  }

  const bool absorbing = condition.kind == "absorbing";
  if (absorbing || !state.absorbing.empty()) {
    protocol::Dashpots dashpots;
    dashpots.name = name;
    state.absorbing.clear();
    state.coefficients.clear();
    if (absorbing) {
      // rho c A: the impedance of a plane wave along the normal (Lysmer & Kuhlemeyer 1969)
      const double along = std::sqrt(elasticity.density * p_modulus(elasticity.stiffness, normal));
      const double across = std::sqrt(elasticity.density * s_modulus(elasticity.stiffness, normal));
      std::vector<double> coefficients;
      for (const double a : patch.area) {
        Triple c{across * a, across * a, across * a};
        c[normal] = along * a;
        put_triple(coefficients, c[0], c[1], c[2]);
        state.coefficients.push_back(c);
      }
      dashpots.entities = patch.entities;
      dashpots.coefficients = coefficients;
      state.absorbing = patch.entities;
    }
    link_->tell(dashpots);
  }

  std::fill(freedom_.begin(), freedom_.end(), Triple{1, 1, 1});
  std::fill(viscosity_.begin(), viscosity_.end(), Triple{});
  for (const State& s : faces_) {
    for (const Hold& h : s.holds)
      for (const std::int32_t e : h.entities)
        for (int axis = 0; axis < 3; ++axis)
          if (h.components & bit(axis)) freedom_[e][axis] = 0.0;
    for (std::size_t k = 0; k < s.absorbing.size(); ++k)
      for (int axis = 0; axis < 3; ++axis) viscosity_[s.absorbing[k]][axis] += s.coefficients[k][axis];
  }
}

/// Rigid walls stand on the faces of the ground's box and do not move.
void FaceSide::set_wall(int face, const scene::Face& condition) {
  std::optional<double>& friction = walls_[face];
  const std::optional<double> wanted = condition.kind == "wall" ? std::optional(condition.friction) : std::nullopt;
  if (wanted == friction) return;
  friction = wanted;
  protocol::Walls walls;
  std::vector<double> points, normals;
  for (int f = 0; f < 6; ++f) {
    if (!walls_[f]) continue;
    Triple point{}, normal{};
    point[f / 2] = f % 2 == 0 ? ground_.lo[f / 2] : ground_.hi[f / 2];
    normal[f / 2] = f % 2 == 0 ? 1.0 : -1.0;
    put_triple(points, point[0], point[1], point[2]);
    put_triple(normals, normal[0], normal[1], normal[2]);
    walls.friction.data.push_back(*walls_[f]);
  }
  const std::uint64_t count = walls.friction.data.size();
  walls.friction.set_shape(std::array<std::uint64_t, 1>{count});
  walls.velocity = std::vector<double>(3 * count, 0.0);
  walls.point = points;
  walls.normal = normals;
  link_->tell(walls);
  link_->ask<protocol::Ready>(protocol::Prepare{});
}

void FaceSide::keep_reactions(const Hold& hold) {
  const std::vector<double> force = link_->fetch("force"), tie = link_->fetch("tie_force");
  protocol::Loads dead;
  dead.name = hold.name + ".dead";
  dead.entities = hold.entities;
  dead.history_kind = "constant";
  dead.history = std::vector<double>{1.0};
  std::vector<double> vectors;
  for (const std::int32_t e : hold.entities)
    for (int axis = 0; axis < 3; ++axis) {
      const bool on = hold.components & bit(axis);
      vectors.push_back(on ? -(force[3 * static_cast<std::size_t>(e) + axis] + tie[3 * static_cast<std::size_t>(e) + axis]) : 0.0);
    }
  dead.vectors = vectors;
  link_->tell(dead);
  dead_[dead.name] = std::move(dead);
}

nlohmann::json FaceSide::dead_loads() const {
  nlohmann::json loads = nlohmann::json::object();
  for (const auto& [name, dead] : dead_) loads[name] = {{"entities", dead.entities.data}, {"vectors", dead.vectors.data}};
  return loads;
}

void FaceSide::tell_dead_loads(const nlohmann::json& loads) {
  for (const auto& [name, saved] : loads.items()) {
    protocol::Loads& dead = dead_[name];
    dead.name = name;
    dead.entities = saved.at("entities").get<std::vector<std::int32_t>>();
    dead.vectors = saved.at("vectors").get<std::vector<double>>();
    dead.history_kind = "constant";
    dead.history = std::vector<double>{1.0};
    link_->tell(dead);
  }
}

Inertia FaceSide::inertia(const std::vector<double>& mass, double dt) const {
  Inertia inertia;
  inertia.freedom = freedom_;
  inertia.mass.resize(mass.size());
  for (std::size_t p = 0; p < mass.size(); ++p)
    for (int axis = 0; axis < 3; ++axis) inertia.mass[p][axis] = mass[p] + 0.5 * dt * viscosity_[p][axis];
  return inertia;
}

Faces::Faces(const scene::Scene& scene, const Assembly& assembly, EngineLink* dem, EngineLink* continuum)
    : assembly_(assembly),
      grains_(dem, assembly.grains.position.size(), scene.ground.box, true),
      nodes_(continuum, assembly.mesh.nodes.size(), scene.ground.box, false) {
  for (int face = 0; face < 6; ++face) {
    if (scene.ground.periodic[face / 2]) continue;
    if (dem) {
      held_grains_[face] = grains_at_face(face, scene.ground.box, assembly.grains);
      grain_patches_[face] = grain_patch(face, scene.ground.box, scene.ground.periodic, assembly.zone, assembly.grains);
    }
    if (continuum) {
      held_nodes_[face] = nodes_at_face(face, assembly.mesh);
      node_patches_[face] = mesh_patch(face, assembly.mesh, assembly.zone);
    }
    if (held_grains_[face].size() > 1)
      seat_grains_[face] = seat_points(face, held_grains_[face], assembly.grains.position, scene.ground.box);
    else
      seat_nodes_[face] = seat_points(face, held_nodes_[face], assembly.mesh.nodes, scene.ground.box);
  }
}

void Faces::apply(int face, const scene::Face& condition) {
  grains_.apply(face, condition, held_grains_[face], seat_grains_[face], grain_patches_[face], assembly_.elasticity);
  nodes_.apply(face, condition, held_nodes_[face], seat_nodes_[face], node_patches_[face], assembly_.elasticity);
}

}  // namespace gabion::coupler
