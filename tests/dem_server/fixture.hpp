#pragma once
// What the physics tests of the engine share.

#include <catch2/catch.hpp>
#include <cmath>
#include <random>

#include "dem_server/engine.hpp"

namespace gabion::dem::testing {

struct NoExchange : engine::Exchange {
  void send_gap(std::span<const double>) override {}
  bool receive_multipliers(std::span<double>) override { return true; }
};

/// k_n = 1e6 r and k_s = 4e5 r N/m per grain, density 2000, infinite friction and strength.
inline GrainMaterial elastic_material() {
  return {1e6, 4e5, 2000.0, INFINITY, INFINITY, INFINITY};
}

inline GrainMaterial frictional_material(double friction) {
  return {1e6, 4e5, 2000.0, friction, 0.0, 0.0};
}

struct Scene {
  DemEngine engine;
  NoExchange exchange;
  double time = 0.0;

  Scene() { engine.options.measure_energy = true; }

  void grains(const VecField& x, const std::vector<double>& r, const GrainMaterial& material) {
    engine.set_grains(x, r, std::vector<std::int32_t>(x.size(), 0));
    engine.set_materials({material});
  }
  void periodic_box(Vec lo, Vec hi) {
    engine.options.box_lo = lo;
    engine.options.box_hi = hi;
    for (bool& p : engine.options.periodic) p = true;
  }
  void prepare(Geometry geometry, bool rotations = true, double skin = 0.0) {
    engine.set_contact_options({geometry, rotations, skin});
    engine.prepare();
  }
  void step(double dt, int count = 1, double damping = 0.0) {
    for (int k = 0; k < count; ++k, time += dt) engine.step({time, dt, damping, k + 1 == count}, exchange);
  }
  void set(const char* field, const VecField& values) {
    std::vector<double> flat;
    for (const Vec v : values)
      for (int axis = 0; axis < 3; ++axis) flat.push_back(v[axis]);
    engine.set_field(field, flat);
  }
  double energy(const std::string& name) const {
    const engine::Ledger ledger = engine.ledger();  // outlives the loop over a part of it
    for (const auto& entry : ledger.entries)
      if (entry.name == name) return entry.energy;
    throw std::out_of_range("no energy " + name);
  }
  double count(const std::string& name) const {
    for (const auto& counter : engine.counters())
      if (counter.name == name) return counter.value;
    throw std::out_of_range("no counter " + name);
  }
  const Vec velocity(std::size_t i) const { return engine.motion.velocity[i]; }
  const Vec spin(std::size_t i) const { return engine.rotation().spin[i]; }
};

/// Random vectors with components in -size to size.
inline VecField random_field(std::size_t n, double size, unsigned seed) {
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> value(-size, size);
  VecField field(n);
  for (Vec& v : field) v = vec(value(random), value(random), value(random));
  return field;
}

struct Spheres {
  VecField x;
  std::vector<double> r;
};

/// A cubic array of side^3 spheres of radii 0.33 to 0.5 and jittered places, spacing 1.
inline Spheres jittered(int side, unsigned seed = 1) {
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> jitter(-0.04, 0.04), size(0.33, 0.5);
  Spheres s;
  for (int k = 0; k < side; ++k)
    for (int j = 0; j < side; ++j)
      for (int i = 0; i < side; ++i) {
        s.x.push_back(vec(i + jitter(random), j + jitter(random), k + jitter(random)));
        s.r.push_back(size(random));
      }
  return s;
}

/// Face-centred cubic cells of side 1, touching spheres.
inline Spheres face_centred(int nx, int ny, int nz) {
  Spheres s;
  for (int k = 0; k < nz; ++k)
    for (int j = 0; j < ny; ++j)
      for (int i = 0; i < nx; ++i)
        for (const Vec b : {vec(0, 0, 0), vec(.5, .5, 0), vec(.5, 0, .5), vec(0, .5, .5)}) {
          s.x.push_back(b + vec(i, j, k));
          s.r.push_back(std::sqrt(0.125));
        }
  return s;
}

}  // namespace gabion::dem::testing
