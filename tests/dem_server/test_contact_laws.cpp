// Two grains: closed forms of impacts, friction, bonds and their energies.

#include <numbers>

#include "fixture.hpp"

using namespace gabion::dem;
using namespace gabion::dem::testing;

namespace {

constexpr double r = 0.5;

/// Two equal grains along x that nearly touch.
struct TwoGrains : Scene {
  explicit TwoGrains(const GrainMaterial& material, double gap = 1e-9) {
    grains({vec(0, 0, 0), vec(2 * r + gap, 0, 0)}, {r, r}, material);
  }
};

}  // namespace

TEST_CASE("oblique impact with infinite friction: ratio of tangential contact velocities") {
  for (const auto& [kn, ks, expected] : {std::array{3.78, 1.13, -0.99742}, std::array{1.77, 0.35, -0.86380}}) {
    const GrainMaterial material{kn * 1e6, ks * 1e6, 2000.0, INFINITY, 0.0, 0.0};
    TwoGrains s(material, 0.0);
    s.prepare(Geometry::updated);
    // slow: the contact plane must not turn during the impact
    const double vn = 1e-4, vt = 0.5e-4;
    s.set("velocity", {vec(vn, vt, 0), vec(-vn, -vt, 0)});
    const double mass = s.engine.motion.mass[0];
    const double period = std::numbers::pi * std::sqrt(0.5 * mass / (0.5 * kn * 1e6 * r));
    // contact ends after half a period of the normal motion
    const int steps = 20000;
    s.step(1.02 * period / steps, steps);
    REQUIRE(s.count("contacts") == 0);
    const double before = 2 * vt;
    const double after = s.velocity(0)[1] - s.velocity(1)[1] + r * (s.spin(0)[2] + s.spin(1)[2]);
    CHECK(after / before == Approx(std::cos(std::numbers::pi * std::sqrt(3.5 * ks / kn))).margin(1e-4));
    CHECK(after / before == Approx(expected).margin(1e-4));
    CHECK(s.velocity(0)[0] == Approx(-vn).epsilon(1e-4));
  }
}

TEST_CASE("gross sliding follows the impulse ratio") {
  const double mu = 0.1, vn = 1e-4, vt = 4e-4;
  TwoGrains s(frictional_material(mu), 0.0);
  s.prepare(Geometry::updated);
  s.set("velocity", {vec(vn, vt, 0), vec(-vn, -vt, 0)});
  const double dt = s.engine.stable_step() / 200;
  s.step(dt, 1000);
  REQUIRE(s.count("contacts") == 0);
  // v_t' = v_t - mu (1 + e) v_n with e = 1; omega' = -2.5 mu (1 + e) v_n/R
  CHECK(s.velocity(0)[1] == Approx(vt - 2 * mu * vn).epsilon(1e-3));
  CHECK(std::fabs(s.spin(0)[2]) == Approx(2.5 * mu * 2 * vn / r).epsilon(1e-3));
  CHECK(s.spin(0)[2] == Approx(s.spin(1)[2]).epsilon(1e-9));
  const double kinetic_before = s.engine.motion.mass[0] * (vn * vn + vt * vt);
  CHECK(s.energy("friction") + s.energy("kinetic") + s.energy("rotational") == Approx(kinetic_before).epsilon(1e-4));
  CHECK(s.energy("friction") > 0.01 * kinetic_before);
}

TEST_CASE("a grain that slides on a floor rolls at 5/7 of its speed") {
  const double mu = 0.3, g = 10.0, u0 = 0.2;
  Scene s;
  s.engine.options.gravity = vec(0, 0, -g);
  GrainMaterial stiff = frictional_material(mu);
  stiff.normal_stiffness = stiff.shear_stiffness = 1e10;
  s.grains({vec(0, 0, r)}, {r}, stiff);
  Wall floor;
  floor.normal = vec(0, 0, 1);
  floor.friction = mu;
  s.engine.set_walls({floor});
  s.prepare(Geometry::updated);
  // start in equilibrium with the weight
  const double sag = s.engine.motion.mass[0] * g / (0.5 * stiff.normal_stiffness * r);
  s.set("displacement", {vec(0, 0, -sag)});
  s.set("velocity", {vec(u0, 0, 0)});
  const double slip_time = 2 * u0 / (7 * mu * g);
  const double dt = slip_time / 4000;
  REQUIRE(dt < s.engine.stable_step());
  s.step(dt, 3800);
  CHECK(s.velocity(0)[0] == Approx(u0 - mu * g * 3800 * dt).epsilon(1e-3));
  CHECK(s.velocity(0)[0] > 1.01 * 5.0 / 7.0 * u0);
  s.step(dt, 400);
  // the shear spring keeps swinging: means over many of its periods
  const int steps = 30000;
  const Vec x = s.engine.motion.displacement[0], angle = s.engine.rotation().angle[0];
  s.step(dt, steps);
  CHECK((s.engine.motion.displacement[0] - x)[0] / (steps * dt) == Approx(5.0 / 7.0 * u0).epsilon(1e-3));
  CHECK((s.engine.rotation().angle[0] - angle)[1] / (steps * dt) == Approx(5.0 / 7.0 * u0 / r).epsilon(1e-3));
}

TEST_CASE("local damping gives the restitution sqrt((1 - a)/(1 + a))") {
  TwoGrains s(frictional_material(0.0), 0.0);
  s.engine.boundary.add({"hold", {1}, 15, vec(0, 0, 0), {}}, 2);
  s.prepare(Geometry::updated);
  const double v = 1e-3, alpha = 0.7;
  s.set("velocity", {vec(v, 0, 0), vec(0, 0, 0)});
  const double dt = s.engine.stable_step() / 20000;
  int steps = 0;
  do {
    s.step(dt, 1, alpha);
    REQUIRE(++steps < 200000);
  } while (steps < 10 || s.count("contacts") > 0);
  CHECK(-s.velocity(0)[0] / v == Approx(std::sqrt((1 - alpha) / (1 + alpha))).margin(1e-4));
  CHECK(-s.velocity(0)[0] / v == Approx(0.4201).margin(1e-4));
}

TEST_CASE("a bond breaks in tension at its strength, and its energy is booked") {
  GrainMaterial material = elastic_material();
  material.friction = 0.5;
  material.normal_strength = 4e3;  // times r^2: 1000 N
  TwoGrains s(material, 0.01);
  CHECK(s.engine.make_bonds(0.05).bonds == 1);
  s.prepare(Geometry::updated);
  const double kn = 0.5 * material.normal_stiffness * r, mass = s.engine.motion.mass[0];
  // just too slow, then fast enough: 1/2 (m/2) v^2 against b^2/(2 k)
  const double critical = 1000.0 / std::sqrt(kn * 0.5 * mass);
  const double dt = s.engine.stable_step() / 400;
  s.set("velocity", {vec(-0.499 * critical, 0, 0), vec(0.499 * critical, 0, 0)});
  s.step(dt, 2000);
  CHECK(s.count("broken") == 0);
  CHECK(s.engine.ledger().balance() == Approx(0.25 * mass * 0.998 * 0.998 * critical * critical).epsilon(1e-4));

  TwoGrains t(material, 0.01);
  t.engine.make_bonds(0.05);
  t.prepare(Geometry::updated);
  t.set("velocity", {vec(-0.6 * critical, 0, 0), vec(0.6 * critical, 0, 0)});
  t.step(dt);
  const double before = t.engine.ledger().balance();
  t.step(dt, 2000);
  CHECK(t.count("broken") == 1);
  CHECK(t.count("bonds") == 0);
  CHECK(t.engine.ledger().balance() == Approx(before).epsilon(1e-12));
  CHECK(t.energy("broken_bonds") == Approx(0.5 * 1000.0 * 1000.0 / kn).epsilon(0.02));
  CHECK(t.energy("elastic") == 0.0);
}

TEST_CASE("a bond breaks in shear, slides with friction after, and the balance stays") {
  GrainMaterial material = elastic_material();
  material.friction = 0.2;
  material.shear_strength = 400.0;  // times r^2: 100 N
  TwoGrains s(material, -0.02);     // overlapping, yet stress-free
  s.engine.make_bonds(0.0);
  s.prepare(Geometry::updated);
  s.step(1e-9);
  CHECK(s.energy("elastic") == 0.0);
  s.set("velocity", {vec(0.3, 0.4, 0), vec(-0.3, -0.4, 0)});
  const double dt = s.engine.stable_step() / 500;
  s.step(dt);
  const double before = s.engine.ledger().balance();
  s.step(dt, 300);
  CHECK(s.count("broken") == 1);
  CHECK(s.count("contacts") == 1);  // compression remains, measured from the bond's length
  CHECK(s.energy("broken_bonds") > 0.0);
  CHECK(s.energy("friction") > 0.0);
  CHECK(s.engine.ledger().balance() == Approx(before).epsilon(1e-5));
}

TEST_CASE("breaking in shear under compression makes no jump in the normal force") {
  GrainMaterial material = elastic_material();
  material.friction = 0.0;
  material.shear_strength = 4.0;
  TwoGrains s(material, -0.02);
  s.engine.make_bonds(0.0);
  s.prepare(Geometry::updated);
  s.set("velocity", {vec(0.1, 0.1, 0), vec(-0.1, -0.1, 0)});
  const double dt = s.engine.stable_step() / 2000;
  double last = 0.0, largest_jump = 0.0;
  std::vector<std::uint64_t> shape;
  for (int k = 0; k < 500; ++k) {
    s.step(dt);
    const auto rows = *s.engine.field("contact", shape);
    REQUIRE(shape[0] == 1);
    largest_jump = std::max(largest_jump, std::fabs(rows[5] - last));
    last = rows[5];
  }
  CHECK(s.count("broken") == 1);
  CHECK(last < 0.0);
  CHECK(largest_jump < 0.01 * std::fabs(last));
}

TEST_CASE("momentum and angular momentum of a frictional collision are kept") {
  TwoGrains s(frictional_material(0.4), 0.01);
  s.prepare(Geometry::updated);
  s.set("velocity", {vec(1.0, 0.3, 0.1), vec(-0.5, -0.4, 0.2)});
  s.set("spin", {vec(0.3, -0.2, 1.0), vec(0.1, 0.5, 0.2)});
  const std::vector<double> before = s.engine.momentum();
  const double dt = s.engine.stable_step() / 20;
  for (int k = 0; k < 400; ++k) {
    s.step(dt);
    const std::vector<double> now = s.engine.momentum();
    for (int c = 0; c < 3; ++c) CHECK(now[c] == Approx(before[c]).margin(1e-12 * before[6]));
    // x(n+1) with v(n+1/2) belong to different times: x x v is the same at both
    for (int c = 3; c < 6; ++c) CHECK(now[c] == Approx(before[c]).margin(1e-11 * before[6]));
  }
  REQUIRE(s.count("contacts") == 0);
  CHECK(s.energy("friction") > 0.0);
}
