#pragma once
// Grains and mesh of a scene, tied in one process: the coupler's own rows and multipliers between the two engines.
//
// The engines meet the coupler in the middle of their steps. Here the grains' step asks for its multipliers, and only
// then the mesh takes its own step up to the same point, solves, and goes on.

#include <algorithm>
#include <cmath>
#include <functional>
#include <memory>
#include <random>

#include "continuum_server/continuum_engine.hpp"
#include "coupler/run/assembly.hpp"
#include "coupler/interface/multipliers.hpp"
#include "dem_server/engine.hpp"

namespace gabion::coupled {

using engine::Vec;
using engine::vec;
using engine::VecField;
using coupler::Point;

/// What a coupled column is made of; lengths in metres.
struct Column {
  int axis = 2;                  ///< the interface is a plane across this axis, grains at the lower end
  std::string model = "bridging", rows = "mortar", lattice = "fcc";
  double radius = 0.05 * 1.4142135623730951;  ///< cell of 0.2 m
  double width = 0.8;                         ///< across, periodic
  double element = 0.4;
  double grains_alone = 0.8, overlap = 0.8, mesh_alone = 1.2;  ///< lengths along the axis
  double floor = 0.01;
  double stiffness = 1.0, density = 1.0;  ///< of the mesh over the lattice's own
  double shift = 0.0;                     ///< of the zone's face, along the axis
};

inline scene::Scene scene_of(const Column& c) {
  scene::Scene s;
  const bool edge = c.model == "edge";
  s.model = edge ? scene::Model::edge : scene::Model::bridging;
  s.ground.box = {{0, 0, 0}, {c.width, c.width, c.width}};
  s.ground.box.hi[c.axis] = c.grains_alone + c.overlap + c.mesh_alone;
  for (int a = 0; a < 3; ++a) s.ground.periodic[a] = a != c.axis;
  s.ground.material = "lattice";
  scene::Material& m = s.materials.emplace_back();
  m.name = "lattice";
  m.normal_stiffness = 3.78e9;
  m.shear_stiffness = 1.13e9;
  m.density = 2650.0;
  m.friction = m.normal_strength = m.shear_strength = scene::infinity;
  s.grains.packing = c.lattice;
  s.grains.radius = {c.radius};
  s.grains.geometry = "frozen";
  s.grains.zone = s.ground.box;
  s.grains.zone->hi[c.axis] = c.grains_alone + (edge ? 0.5 : 1.0) * c.overlap + c.shift;
  s.mesh.size = c.element;
  s.coupling.overlap = c.overlap;
  s.coupling.rows = c.rows;
  s.coupling.weight_floor = c.floor;
  s.coupling.reach = c.lattice == "sc" ? 1.01 : 0.9;
  return s;
}

/// Closed form of a lattice of contact stiffnesses k_n, k_s and radius R; see docs/verification.md.
inline coupler::Elasticity lattice_elasticity(const scene::Scene& s, double radius, double stiffness, double density) {
  const scene::Material& m = s.materials[0];
  const double kn = 0.5 * m.normal_stiffness * radius, ks = 0.5 * m.shear_stiffness * radius, root = std::sqrt(2.0);
  const bool fcc = s.grains.packing == "fcc";
  const double c11 = fcc ? (kn + ks) / (root * radius) : kn / (2 * radius);
  const double c12 = fcc ? (kn - ks) / (2 * root * radius) : 0.0;
  const double c44 = fcc ? (kn + ks) / (2 * root * radius) : ks / (4 * radius);
  coupler::Elasticity e;
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) e.stiffness[i][j] = stiffness * (i == j ? c11 : c12);
    e.stiffness[i + 3][i + 3] = stiffness * c44;
  }
  const double pi = std::acos(-1.0);
  e.density = density * m.density * (fcc ? pi / (3 * root) : pi / 6);
  return e;
}

class Coupled {
 public:
  coupler::Assembly ground;
  dem::DemEngine dem;
  continuum::ContinuumEngine solid;
  coupler::InterfaceRows rows;
  std::unique_ptr<coupler::Multipliers> multipliers;
  double time = 0.0;

  explicit Coupled(const Column& c) : Coupled(scene_of(c), c.stiffness, c.density) {}
  /// A lattice; stiffness and density of the mesh over the lattice's own.
  Coupled(const scene::Scene& s, double stiffness = 1.0, double density = 1.0)
      : Coupled(s, coupler::make_lattice(s), lattice_elasticity(s, coupler::make_lattice(s).radius[0], stiffness, density)) {}
  Coupled(const scene::Scene& s, const coupler::Packing& packing, const coupler::Elasticity& elasticity) : scene_(s) {
    ground = coupler::assemble(s, packing, elasticity);
    for (engine::Engine* e : both()) {
      e->options.measure_energy = true;
      for (int a = 0; a < 3; ++a) {
        e->options.box_lo[a] = s.ground.box.lo[a];
        e->options.box_hi[a] = s.ground.box.hi[a];
        e->options.periodic[a] = s.ground.periodic[a];
      }
      const bool weighted = ground.zone.overlap() > 0.0;
      if (!weighted && !(e == &dem && s.coupling.border_weights)) continue;
      for (int a = 0; a < 3; ++a) {
        e->weights.outer_lo[a] = ground.zone.outer().lo[a];
        e->weights.outer_hi[a] = ground.zone.outer().hi[a];
      }
      e->weights.width = ground.zone.overlap();
      e->weights.floor = ground.zone.weight_floor();
    }
    set_up_grains();
    set_up_mesh();
    rows = coupler::build_rows(s.coupling.rows, ground.mesh, ground.zone, ground.grains, s.coupling.reach);
    if (s.coupling.solve == "row_sum") rows = coupler::explicit_rows(rows);
    const auto mode = rows.kind == coupler::InterfaceRows::Kind::gap ? engine::Tie::Mode::gap : engine::Tie::Mode::slave;
    dem.tie.set(mode, rows.slots, rows.tied_grains, rows.grains.row_ptr, rows.grains.columns, rows.grains.values, dem.motion);
    solid.tie.set(mode, rows.slots, rows.tied_nodes, rows.nodes.row_ptr, rows.nodes.columns, rows.nodes.values, solid.motion);
    from_grains_.resize(3 * rows.slots);
    from_nodes_.resize(3 * rows.slots);
    answer_.resize(3 * rows.slots);
    multipliers = std::make_unique<coupler::Multipliers>(rows, inertia(dem.motion), inertia(solid.motion), s.coupling.solve == "row_sum");
  }

  std::array<engine::Engine*, 2> both() { return {&dem, &solid}; }
  double stable_step() { return std::min(dem.stable_step(), solid.stable_step()); }

  void step(double dt, int count = 1, double damping = 0.0) {
    for (int k = 0; k < count; ++k, time += dt) {
      context_ = {time, dt, damping, k + 1 == count};
      GrainSide side(*this);
      dem.step(context_, side);
    }
  }

  /// Each component uniform in [-size, size], the same for the same seed.
  void shake(double size, unsigned seed = 1) {
    std::mt19937_64 random(seed);
    std::uniform_real_distribution<double> value(-size, size);
    for (engine::Engine* e : both())
      set(*e, "velocity", [&](Vec) { return vec(value(random), value(random), value(random)); });
  }
  static void set(engine::Engine& e, const char* field, const std::function<Vec(Vec)>& of_place) {
    std::vector<double> values;
    for (const Vec x : e.motion.position) {
      const Vec v = of_place(x);
      values.insert(values.end(), {v[0], v[1], v[2]});
    }
    e.set_field(field, values);
  }

  double balance() const { return dem.ledger().balance() + solid.ledger().balance(); }
  static double entry(const engine::Engine& e, const std::string& name) {
    const engine::Ledger ledger = e.ledger();
    for (const auto& one : ledger.entries)
      if (one.name == name) return one.energy;
    return 0.0;
  }
  double largest_speed() const { return std::max(dem.motion.largest_speed(), solid.motion.largest_speed()); }

  /// Largest component of the gap in a field of both media.
  double gap(const VecField& of_grains, const VecField& of_nodes) const {
    double largest = 0.0;
    const bool slave = rows.kind == coupler::InterfaceRows::Kind::slave;
    const auto times = [](const coupler::SparseRows& m, std::size_t r, const std::function<Vec(std::int32_t)>& value) {
      Vec total{};
      for (std::int32_t k = m.row_ptr[r]; k < m.row_ptr[r + 1]; ++k) total += engine::splat(m.values[k]) * value(m.columns[k]);
      return total;
    };
    for (std::size_t r = 0; r < rows.grains.rows(); ++r) {
      Vec gap = slave ? of_grains[rows.tied_grains[r]] - times(rows.grains, r, [&](std::int32_t s) { return of_nodes[rows.tied_nodes[s]]; })
                      : times(rows.grains, r, [&](std::int32_t i) { return of_grains[i]; }) +
                            times(rows.nodes, r, [&](std::int32_t n) { return of_nodes[n]; });
      for (int a = 0; a < 3; ++a) largest = std::max(largest, std::fabs(gap[a]));
    }
    return largest;
  }
  double velocity_gap() const { return gap(dem.motion.velocity, solid.motion.velocity); }
  double displacement_gap() const { return gap(dem.motion.displacement, solid.motion.displacement); }

  Vec momentum() const {
    const auto a = dem.momentum(), b = solid.momentum();
    return vec(a[0] + b[0], a[1] + b[1], a[2] + b[2]);
  }

 private:
  /// The mesh's end of the exchange: its trial motion is there, the grains' has been.
  struct NodeSide : engine::Exchange {
    explicit NodeSide(Coupled& all_) : all(all_) {}
    void send_gap(std::span<const double> gap) override { std::copy(gap.begin(), gap.end(), all.from_nodes_.begin()); }
    bool receive_multipliers(std::span<double> values) override {
      all.multipliers->solve(all.from_grains_, all.from_nodes_, all.answer_);
      std::copy(all.answer_.begin(), all.answer_.end(), values.begin());
      return true;
    }
    Coupled& all;
  };
  struct GrainSide : engine::Exchange {
    explicit GrainSide(Coupled& all_) : all(all_) {}
    void send_gap(std::span<const double> gap) override { std::copy(gap.begin(), gap.end(), all.from_grains_.begin()); }
    bool receive_multipliers(std::span<double> values) override {
      NodeSide side(all);
      all.solid.step(all.context_, side);
      std::copy(all.answer_.begin(), all.answer_.end(), values.begin());
      return true;
    }
    Coupled& all;
  };

  void set_up_grains() {
    std::vector<dem::GrainMaterial> materials;
    for (const scene::Material& m : scene_.materials)
      materials.push_back({m.normal_stiffness, m.shear_stiffness, m.density, m.friction, m.normal_strength, m.shear_strength});
    VecField x;
    for (const Point& p : ground.grains.position) x.push_back(vec(p[0], p[1], p[2]));
    dem.set_grains(x, ground.grains.radius, ground.material);
    dem.set_materials(materials);
    const auto geometry = scene_.grains.geometry == "frozen" ? dem::Geometry::frozen : dem::Geometry::updated;
    dem.set_contact_options({geometry, scene_.grains.rotations, 0.0});
    dem.make_bonds(ground.bond_gap);
    dem.prepare();
    ground.grains.plain_mass = dem.motion.plain_mass;
  }

  void set_up_mesh() {
    continuum::Mesh mesh;
    for (const Point& p : ground.mesh.nodes) mesh.nodes.push_back(vec(p[0], p[1], p[2]));
    mesh.elements = ground.mesh.elements;
    mesh.wrap = ground.mesh.wrap;
    mesh.material.assign(mesh.elements.size(), 0);
    continuum::SolidMaterial material{};
    for (int i = 0; i < 6; ++i)
      for (int j = 0; j < 6; ++j) material.stiffness[6 * i + j] = ground.elasticity.stiffness[i][j];
    material.density = ground.elasticity.density;
    solid.set_mesh(std::move(mesh));
    solid.set_materials({material});
    solid.prepare();
  }

  static coupler::Inertia inertia(const engine::Motion& motion) {
    coupler::Inertia result;
    for (std::size_t i = 0; i < motion.size(); ++i) {
      result.mass.push_back({motion.mass[i], motion.mass[i], motion.mass[i]});
      result.freedom.push_back({motion.freedom[i][0], motion.freedom[i][1], motion.freedom[i][2]});
    }
    return result;
  }

  scene::Scene scene_;
  engine::StepContext context_;
  std::vector<double> from_grains_, from_nodes_, answer_;
};

/// Whether random motion stays bounded at this step. Without damping growth is seen down to 1e-4 above the limit.
inline bool stays_bounded(Coupled& all, double dt, int steps = 3000, double damping = 0.0) {
  all.shake(1e-3);
  try {
    for (int part = 0; part < steps / 100; ++part) {
      all.step(dt, 100, damping);
      if (!(all.largest_speed() < 10.0)) return false;
    }
  } catch (const engine::PhysicsError&) {
    return false;
  }
  return true;
}

/// Largest stable step over the smaller of the two media's own, by bisection between 0.5 and 2; 0 when none of these is stable.
inline double stable_fraction(const std::function<std::unique_ptr<Coupled>()>& make, double width = 1e-3, int steps = 3000,
                              double damping = 0.0) {
  const double limit = make()->stable_step();
  double low = 0.5, high = 2.0;
  if (!stays_bounded(*make(), low * limit, steps, damping)) return 0.0;
  while (high - low > width) {
    const double middle = 0.5 * (low + high);
    (stays_bounded(*make(), middle * limit, steps, damping) ? low : high) = middle;
  }
  return low;
}

}  // namespace gabion::coupled
