// Rolling resistance: closed forms of a sphere on a plane and of two grains.

#include <numbers>

#include "fixture.hpp"

using namespace gabion::dem;
using namespace gabion::dem::testing;

namespace {

constexpr double r = 0.5, half_overlap = 0.005;

GrainMaterial rolling(double beta, double eta, double friction = 10.0) {
  GrainMaterial m = frictional_material(friction);
  m.rolling_stiffness = beta;
  m.rolling_friction = eta;
  return m;
}

/// Two grains that are pressed together and held in place but may turn, spinning like two gears.
struct Gears : Scene {
  double force, inertia;
  Gears(const GrainMaterial& material, double spin, bool bond = false, double rj = r) {
    const double overlap = 2 * half_overlap;
    grains({vec(0, 0, 0), vec(r + rj - overlap, 0, 0)}, {r, rj}, material);
    if (bond) engine.make_bonds(0.0);
    engine.boundary.add({"hold", {0, 1}, 7, vec(0, 0, 0), {}}, 2);
    prepare(Geometry::updated);
    set("spin", {vec(0, 0, spin), vec(0, 0, -spin * (r - half_overlap) / (rj - half_overlap))});
    force = contact_spring(engine.grains(), 0, 1, 1.0).normal * overlap;
    inertia = engine.rotation().inertia[0];
  }
};

}  // namespace

TEST_CASE("a sphere that rolls on a plane slows down by 5/7 eta g") {
  const double g = 10.0, eta = 0.05, v0 = 0.5;
  Scene s;
  s.engine.options.gravity = vec(0, 0, -g);
  GrainMaterial stiff = rolling(1.0, eta);
  stiff.normal_stiffness = stiff.shear_stiffness = 1e9;
  s.grains({vec(0, 0, r)}, {r}, stiff);
  Wall floor;
  floor.normal = vec(0, 0, 1);
  floor.friction = 10.0;
  s.engine.set_walls({floor});
  s.prepare(Geometry::updated);
  const double sag = s.engine.motion.mass[0] * g / (0.5 * stiff.normal_stiffness * r);
  s.set("displacement", {vec(0, 0, -sag)});
  s.set("velocity", {vec(v0, 0, 0)});
  s.set("spin", {vec(0, v0 / r, 0)});
  const double deceleration = 5.0 / 7.0 * eta * g, stop = v0 / deceleration;
  const int steps = 40000;
  const double dt = 0.8 * stop / steps;
  REQUIRE(dt < s.engine.stable_step());
  s.step(dt);
  const double before = s.engine.ledger().balance();
  s.step(dt, steps - 1);
  const double t = 0.8 * stop;
  CHECK(s.engine.motion.displacement[0][0] == Approx(v0 * t - 0.5 * deceleration * t * t).epsilon(1e-3));
  CHECK(s.engine.rotation().angle[0][1] == Approx((v0 * t - 0.5 * deceleration * t * t) / r).epsilon(1e-3));
  CHECK(s.energy("rolling") == Approx(0.7 * s.engine.motion.mass[0] * v0 * v0 * (1 - 0.2 * 0.2)).epsilon(2e-3));
  CHECK(s.engine.ledger().balance() == Approx(before).epsilon(1e-6));
}

TEST_CASE("two grains like gears: rolling stiffness, limit, loss; twist is free") {
  const double beta = 0.7;
  SECTION("the spring alone: spins swing with 2 k_r/I") {
    Gears s(rolling(beta, INFINITY), 1e-3);
    const double kr = beta * 0.5 * 4e5 * r * r * r, period = 2 * std::numbers::pi * std::sqrt(s.inertia / (2 * kr));
    s.step(period / 4000, 1000);
    CHECK(s.spin(0)[2] == Approx(0.0).margin(2e-6));
    CHECK(s.energy("rotational") == Approx(0.0).margin(1e-5 * s.inertia * 1e-6));
    s.step(period / 4000, 1000);
    CHECK(s.spin(0)[2] == Approx(-1e-3).epsilon(1e-5));
    CHECK(s.spin(1)[2] == Approx(1e-3).epsilon(1e-5));
    CHECK(s.energy("rolling") == 0.0);
  }
  SECTION("the limit: eta, the smaller radius and the force") {
    for (const double rj : {r, 0.3}) {
      const double eta = 0.02, spin = 2.0, ratio = (r - half_overlap) / (rj - half_overlap);
      Gears s(rolling(beta, eta), spin, false, rj);
      // neither slips: the power of the moment is M omega (1 + ratio), the inertia that of both
      const double inertia = s.inertia + ratio * ratio * s.engine.rotation().inertia[1];
      const double slowing = eta * rj * s.force * (1 + ratio) / inertia, t = 0.5 * spin / slowing;
      const int steps = 20000;
      REQUIRE(t / steps < s.engine.stable_step());
      s.step(t / steps, steps);
      // angles: the shear spring between the two swings a little
      CHECK(s.engine.rotation().angle[0][2] == Approx(0.75 * spin * t).epsilon(1e-3));
      CHECK(s.engine.rotation().angle[1][2] == Approx(-0.75 * spin * ratio * t).epsilon(1e-3));
      CHECK(s.energy("rolling") == Approx(0.375 * inertia * spin * spin).epsilon(2e-3));
      CHECK(s.energy("friction") == 0.0);
    }
  }
  SECTION("twist") {
    Gears s(rolling(beta, 0.1), 0.0);
    s.set("spin", {vec(0.3, 0, 0), vec(-0.2, 0, 0)});
    s.step(0.5 * s.engine.stable_step(), 200);
    CHECK(s.spin(0)[0] == 0.3);
    CHECK(s.spin(1)[0] == -0.2);
    CHECK(s.energy("rolling") == 0.0);
  }
  SECTION("a bond transmits no moment; once broken the contact does") {
    GrainMaterial m = rolling(beta, 0.1);
    m.normal_strength = m.shear_strength = INFINITY;
    Gears s(m, 1.0, true);
    s.step(0.5 * s.engine.stable_step(), 500);
    CHECK(s.spin(0)[2] == 1.0);
    m.shear_strength = 0.0;
    Gears t(m, 1.0, true);
    t.set("spin", {vec(0, 0, 1.0), vec(0, 0, -0.9)});  // not quite gears: the bond is sheared
    t.step(0.5 * t.engine.stable_step(), 500);
    CHECK(t.count("broken") == 1);
    CHECK(t.energy("elastic") == 0.0);  // stress-free as it was bonded: no force, no limit, no moment
    // pressed together by a quarter of the overlap, it resists
    t.set("displacement", {vec(0.5 * half_overlap, 0, 0), vec(0, 0, 0)});
    t.step(0.5 * t.engine.stable_step(), 500);
    CHECK(t.energy("rolling") > 0.0);
  }
}
