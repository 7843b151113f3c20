// Contact damping: collisions, Coulomb's limit, stable step.

#include <numbers>

#include "dem_server/restitution.hpp"
#include "fixture.hpp"

using namespace gabion::dem;
using namespace gabion::dem::testing;

namespace {

constexpr double r = 0.5;

GrainMaterial bouncing(double restitution, double friction = 0.0) {
  GrainMaterial m = frictional_material(friction);
  m.restitution = restitution;
  return m;
}

/// Largest tension and ratio of shear to compression between two grains, from the force of the last step.
struct Extremes {
  double tension = 0.0, shear_ratio = 0.0;
  void look(const Scene& s, double dt) {
    const auto& m = s.engine.motion;
    const auto place = [&](std::size_t i) { return m.position[i] + m.displacement[i] - splat(dt) * m.velocity[i]; };
    const Vec branch = place(1) - place(0), n = branch / splat(norm(branch)), f = m.force[0];
    const double normal = dot(f, n);
    tension = std::max(tension, normal);
    if (normal < 0.0) shear_ratio = std::max(shear_ratio, norm(f - splat(normal) * n) / -normal);
  }
};

/// Speed after over speed before of two grains that meet head on, steps a fraction of the stable one.
double measured_restitution(Scene& s, double fraction, Extremes* seen = nullptr) {
  const double v = 1e-3;
  s.set("velocity", {vec(v, 0, 0), vec(-v, 0, 0)});
  const double dt = fraction * s.engine.stable_step();
  for (int k = 0; k < 400000; ++k) {
    s.step(dt);
    if (seen) seen->look(s, dt);
    if (k > 10 && s.count("contacts") == 0) return (s.velocity(1)[0] - s.velocity(0)[0]) / (2 * v);
  }
  return NAN;
}

}  // namespace

TEST_CASE("damping ratio of a restitution: limits and the critical dashpot") {
  CHECK(damping_ratio(1.0) == 0.0);
  CHECK(damping_ratio(std::exp(-2.0)) == Approx(1.0).epsilon(1e-6));
  // weak damping: -ln e = pi gamma - 2 gamma^2 + ...
  CHECK(-std::log(0.999) == Approx(std::numbers::pi * damping_ratio(0.999)).epsilon(1e-3));
  // strong damping: e = 1/(4 gamma^2)
  CHECK(4.0 * std::pow(damping_ratio(1e-5), 2) * 1e-5 == Approx(1.0).epsilon(1e-3));
  for (double last = 1e9, e = 0.01; e <= 1.0; e += 0.01) {
    CHECK(damping_ratio(e) < last);
    last = damping_ratio(e);
  }
}

TEST_CASE("two grains part with the stated restitution, without tension, and the loss is booked") {
  for (const double e : {0.95, 0.8, 0.5, 0.2, 0.1, 0.03}) {
    INFO("restitution " << e);
    Scene s;
    s.grains({vec(0, 0, 0), vec(2 * r + 1e-9, 0, 0)}, {r, r}, bouncing(e));
    s.prepare(Geometry::updated);
    Extremes seen;
    CHECK(measured_restitution(s, 1.0 / 2000, &seen) == Approx(e).margin(3e-4));
    CHECK(seen.tension == 0.0);
    const double before = s.engine.motion.mass[0] * 1e-6;
    CHECK(s.energy("contact_damping") == Approx((1 - e * e) * before).epsilon(1e-3));
    CHECK(s.energy("contact_damping") + s.energy("kinetic") == Approx(before).epsilon(1e-5));
  }
}

TEST_CASE("unequal grains of two materials, a small one at a wall and at the block: the smaller restitution") {
  const double e = 0.4;
  Scene s;
  s.engine.set_grains({vec(0, 0, 0), vec(0.7 + 1e-9, 0, 0)}, {r, 0.2}, {0, 1});
  GrainMaterial other = bouncing(0.9);
  other.normal_stiffness *= 3;
  s.engine.set_materials({bouncing(e), other});
  s.prepare(Geometry::updated);
  CHECK(measured_restitution(s, 1.0 / 4000) == Approx(e).margin(5e-4));

  for (const bool block : {false, true}) {
    INFO((block ? "block" : "wall"));
    Scene t;
    t.grains({vec(0, 0, 0)}, {r}, bouncing(e));
    if (block) {
      BlockSetup setup;
      setup.vertices = {vec(r, -1, -1), vec(r + 1, -1, -1), vec(r + 1, 1, -1), vec(r, 1, -1),
                        vec(r, -1, 1),  vec(r + 1, -1, 1),  vec(r + 1, 1, 1),  vec(r, 1, 1)};
      setup.face_ptr = {0, 4, 8, 12, 16, 20, 24};
      setup.face_vertices = {0, 3, 2, 1, 4, 5, 6, 7, 0, 1, 5, 4, 2, 3, 7, 6, 0, 4, 7, 3, 1, 2, 6, 5};
      setup.mass = 300.0;
      setup.friction = 0.0;
      t.engine.set_block(setup);
    } else {
      Wall wall;
      wall.point = vec(r, 0, 0);
      wall.normal = vec(-1, 0, 0);
      t.engine.set_walls({wall});
    }
    t.prepare(Geometry::updated);
    const double mass = t.engine.motion.mass[0], reduced = block ? mass * 300.0 / (mass + 300.0) : mass;
    const double v = 1e-3, dt = std::sqrt(reduced / (0.5 * 1e6 * r)) / 2000;
    REQUIRE(dt < t.engine.stable_step());
    t.set("velocity", {vec(v, 0, 0)});
    int steps = 0;
    do {
      t.step(dt);
      REQUIRE(++steps < 100000);
    } while (steps < 10 || t.count("surface_contacts") > 0);
    const double away = block ? t.engine.block().now.velocity[0] : 0.0;
    CHECK((away - t.velocity(0)[0]) / v == Approx(e).margin(5e-4));
    CHECK(t.energy("contact_damping") == Approx(0.5 * reduced * v * v * (1 - e * e)).epsilon(2e-3));
  }
}

TEST_CASE("sliding and damped: the impulses keep Coulomb's ratio, and so does every force") {
  const double mu = 0.1, vn = 1e-4, vt = 4e-4, e = 0.5;
  Scene s;
  s.grains({vec(0, 0, 0), vec(2 * r, 0, 0)}, {r, r}, bouncing(e, mu));
  s.prepare(Geometry::updated);
  s.set("velocity", {vec(vn, vt, 0), vec(-vn, -vt, 0)});
  const double dt = s.engine.stable_step() / 2000;
  Extremes seen;
  for (int k = 0; k < 8000; ++k) {
    s.step(dt);
    if (k % 10 == 0) seen.look(s, dt);
  }
  REQUIRE(s.count("contacts") == 0);
  CHECK(s.velocity(0)[1] == Approx(vt - mu * (1 + e) * vn).epsilon(1e-4));
  CHECK(seen.shear_ratio == Approx(mu).epsilon(1e-9));
  CHECK(seen.tension == 0.0);
  const double before = s.engine.motion.mass[0] * (vn * vn + vt * vt);
  CHECK(s.engine.ledger().balance() == Approx(before).epsilon(1e-5));
}

TEST_CASE("sticking and damped: no force leaves Coulomb's cone") {
  const double mu = 0.4;
  Scene s;
  s.grains({vec(0, 0, 0), vec(2 * r, 0, 0)}, {r, r}, bouncing(0.3, mu));
  s.prepare(Geometry::updated);
  s.set("velocity", {vec(1e-3, 5e-4, 0), vec(-1e-3, -5e-4, 0)});
  const double dt = s.engine.stable_step() / 1000;
  Extremes seen;
  for (int k = 0; k < 8000; ++k) {
    s.step(dt);
    seen.look(s, dt);
  }
  REQUIRE(s.count("contacts") == 0);
  CHECK(seen.tension == 0.0);
  CHECK(seen.shear_ratio <= mu * (1 + 1e-12));
  CHECK(seen.shear_ratio > 0.9 * mu);  // the dashpot meets the limit
  CHECK(s.engine.ledger().balance() == Approx(s.engine.motion.mass[0] * 1.25e-6).epsilon(1e-4));
}

TEST_CASE("the stable step of a damped grain between walls is the closed form's") {
  // omega dt + 2 zeta < 2 sqrt(1 + zeta^2) for u'' + 2 zeta omega u' + omega^2 u with the velocity of half a step
  // before
  for (const double e : {1.0, 0.5, 0.05}) {
    INFO("restitution " << e);
    const auto make = [e](Scene& s) {
      s.grains({vec(0, 0, 0)}, {r}, bouncing(e));
      Wall left, right;
      left.point = vec(-r + 0.01, 0, 0);
      left.normal = vec(1, 0, 0);
      right.point = vec(r - 0.01, 0, 0);
      right.normal = vec(-1, 0, 0);
      s.engine.set_walls({left, right});
      s.prepare(Geometry::updated, false);
      s.set("velocity", {vec(1e-6, 0, 0)});
    };
    Scene below, above;
    make(below);
    make(above);
    const double mass = below.engine.motion.mass[0], omega = std::sqrt(1e6 * r / mass);
    const double zeta = std::sqrt(2.0) * damping_ratio(e);  // c = 2 c_wall, k = 2 k_wall
    const double limit = 2.0 * (std::sqrt(1.0 + zeta * zeta) - zeta) / omega;
    CHECK(below.engine.stable_step() == Approx(limit).epsilon(1e-3));
    CHECK(below.engine.stable_step() <= limit * (1 + 1e-12));
    // strong dashpots make the swing between steps slow to grow
    below.step(0.97 * limit, 400);
    above.step(1.03 * limit, 400);
    CHECK(std::fabs(below.velocity(0)[0]) < 1e-5);
    CHECK(std::fabs(above.velocity(0)[0]) > 1e-4);
  }
}
