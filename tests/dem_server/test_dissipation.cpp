// Rolling resistance, contact damping and locked grains: closed forms, energy, checkpoints, threads.

#include <numbers>

#include "dem_server/restitution.hpp"
#include "fixture.hpp"

using namespace gabion::dem;
using namespace gabion::dem::testing;

namespace {

constexpr double r = 0.5, half_overlap = 0.005;

GrainMaterial bouncing(double restitution, double friction = 0.0) {
  GrainMaterial m = frictional_material(friction);
  m.restitution = restitution;
  return m;
}

GrainMaterial rolling(double beta, double eta, double friction = 10.0) {
  GrainMaterial m = frictional_material(friction);
  m.rolling_stiffness = beta;
  m.rolling_friction = eta;
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

TEST_CASE("momentum and angular momentum are kept with rolling resistance and dashpots") {
  GrainMaterial m = rolling(1.0, 0.1, 0.4);
  m.restitution = 0.6;
  Scene s;
  s.grains({vec(0, 0, 0), vec(2 * r + 0.01, 0, 0)}, {r, r}, m);
  s.prepare(Geometry::updated);
  s.set("velocity", {vec(1.0, 0.3, 0.1), vec(-0.5, -0.4, 0.2)});
  s.set("spin", {vec(0.3, -0.2, 1.0), vec(0.1, 0.5, 0.2)});
  const std::vector<double> before = s.engine.momentum();
  s.step(s.engine.stable_step() / 20, 1200);
  const std::vector<double> now = s.engine.momentum();
  for (int c = 0; c < 6; ++c) CHECK(now[c] == Approx(before[c]).margin(1e-11 * before[6]));
  REQUIRE(s.count("contacts") == 0);
  CHECK(s.energy("rolling") > 0.0);
  CHECK(s.energy("contact_damping") > 0.0);
}

TEST_CASE("weights in an overlap leave the motion of two grains as it is") {
  const auto run = [](double weight) {
    GrainMaterial m = rolling(1.0, 0.1, 0.4);
    m.restitution = 0.6;
    Scene s;
    s.engine.weights.outer_hi = vec(100, 100, 100);
    s.engine.weights.outer_lo = vec(10, -100, -100);  // both grains lie outside: their weight is the floor
    s.engine.weights.width = 1.0;
    s.engine.weights.floor = weight;
    s.grains({vec(0, 0, 0), vec(2 * r + 0.01, 0, 0)}, {r, r}, m);
    s.prepare(Geometry::updated);
    s.set("velocity", {vec(1.0, 0.3, 0.1), vec(-0.5, -0.4, 0.2)});
    s.set("spin", {vec(0.3, -0.2, 1.0), vec(0.1, 0.5, 0.2)});
    s.step(1e-4, 500);
    return std::array{s.velocity(0), s.spin(1)};
  };
  const auto whole = run(1.0), quarter = run(0.25);
  for (std::size_t k = 0; k < 2; ++k)
    for (int axis = 0; axis < 3; ++axis) CHECK(quarter[k][axis] == Approx(whole[k][axis]).epsilon(1e-10));
}

TEST_CASE("the stable step of a damped grain between walls is the closed form's") {
  // omega dt + 2 zeta < 2 sqrt(1 + zeta^2) for u'' + 2 zeta omega u' + omega^2 u with the velocity of half a step before
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

TEST_CASE("a cube falls into grains that roll and bounce: momentum, energy, checkpoint") {
  const auto make = [](Scene& s) {
    Spheres grains = jittered(4);
    GrainMaterial m = rolling(0.5, 0.2, 0.5);
    m.restitution = 0.5;
    s.grains(grains.x, grains.r, m);
    BlockSetup setup;
    for (int v = 0; v < 8; ++v)
      setup.vertices.push_back(vec(1.5, 1.6, 4.25) + splat(0.75) * vec(v & 1 ? 1 : -1, v & 2 ? 1 : -1, v & 4 ? 1 : -1));
    setup.face_ptr = {0, 4, 8, 12, 16, 20, 24};
    setup.face_vertices = {0, 2, 3, 1, 4, 5, 7, 6, 0, 1, 5, 4, 2, 6, 7, 3, 0, 4, 6, 2, 1, 3, 7, 5};
    setup.mass = 3000.0;
    setup.friction = 0.5;
    setup.velocity = vec(0.5, 0, -3);
    setup.spin = vec(0.3, 0.1, 0.2);
    s.engine.set_block(setup);
    s.prepare(Geometry::updated);
  };
  Scene whole, first, second;
  make(whole);
  make(first);
  make(second);
  const double dt = 0.05 * whole.engine.stable_step();
  whole.step(dt);
  const double before = whole.engine.ledger().balance();
  const std::vector<double> momentum = whole.engine.momentum();
  whole.step(dt, 9999);
  const std::vector<double> after = whole.engine.momentum();
  for (int c = 0; c < 3; ++c) CHECK(after[c] == Approx(momentum[c]).margin(1e-12 * momentum[6]));
  for (int c = 3; c < 6; ++c) CHECK(after[c] == Approx(momentum[c]).margin(1e-8 * momentum[6]));
  CHECK(whole.energy("rolling") > 1e-3 * before);
  CHECK(whole.energy("contact_damping") > 1e-2 * before);
  CHECK(whole.engine.ledger().balance() == Approx(before).epsilon(1e-3));

  int steps = 0;
  while (first.count("surface_contacts") < 2 && steps < 9000) first.step(dt), ++steps;
  REQUIRE(first.count("surface_contacts") >= 2);
  second.engine.restore(first.engine.checkpoint());
  second.time = first.time;
  second.step(dt, 10000 - steps);
  CHECK(second.engine.state_hash() == whole.engine.state_hash());
  CHECK(second.energy("rolling") == whole.energy("rolling"));
  CHECK(second.energy("contact_damping") == whole.energy("contact_damping"));
}

TEST_CASE("grains of a locked material do not rotate, others do") {
  GrainMaterial free = frictional_material(0.5), locked = free;
  locked.rotates = false;
  Scene s;
  s.engine.set_grains({vec(0, 0, 0), vec(1.0, 0.2, 0)}, {r, r}, {0, 1});
  s.engine.set_materials({free, locked});
  s.prepare(Geometry::updated);
  s.set("velocity", {vec(0.1, 0.1, 0), vec(-0.1, 0, 0.05)});
  s.set("spin", {vec(0, 0, 0), vec(0.2, 0.1, 0)});
  s.step(1e-3);
  const double before = s.engine.ledger().balance();
  s.step(s.engine.stable_step() / 50, 2000);
  CHECK(norm(s.spin(1)) == 0.0);
  CHECK(norm(s.engine.rotation().angle[1]) == 0.0);
  CHECK(norm(s.spin(0)) > 1e-3);
  CHECK(s.engine.ledger().balance() == Approx(before).epsilon(1e-3));
}

TEST_CASE("values that make no sense are refused") {
  DemEngine engine;
  for (const auto& [change, word] :
       {std::pair{+[](GrainMaterial& m) { m.restitution = 0.0; }, "restitution"},
        std::pair{+[](GrainMaterial& m) { m.restitution = 1.1; }, "restitution"},
        std::pair{+[](GrainMaterial& m) { m.rolling_stiffness = -1.0; }, "at least 0"},
        std::pair{+[](GrainMaterial& m) { m.rolling_friction = NAN; }, "at least 0"}}) {
    GrainMaterial m = frictional_material(0.5);
    change(m);
    try {
      engine.set_materials({m});
      FAIL("accepted");
    } catch (const gabion::engine::RequestError& error) {
      CHECK_THAT(error.advice, Catch::Contains(word));
    }
  }
}

namespace {

/// Touching spheres of a free and a locked material that are stirred on a floor; some bonds break.
void stirred(Scene& scene, double skin = 0.0, int threads = 1, unsigned seed = 3) {
  Spheres s = jittered(5);
  for (double& radius : s.r) radius *= 1.08;
  GrainMaterial first = rolling(0.5, 0.1, 0.4);
  first.restitution = 0.5;
  first.normal_strength = 2e4;
  first.shear_strength = 1e4;
  GrainMaterial second = first;
  second.rotates = false;
  second.restitution = 1.0;
  scene.engine.threads = threads;
  std::vector<std::int32_t> material(s.x.size());
  for (std::size_t i = 0; i < material.size(); ++i) material[i] = i % 7 == 0;
  scene.engine.set_grains(s.x, s.r, material);
  scene.engine.set_materials({first, second});
  Wall floor;
  floor.point = vec(0, 0, -0.4);
  floor.normal = vec(0, 0, 1);
  floor.friction = 0.6;
  scene.engine.set_walls({floor});
  scene.engine.make_bonds(0.0);
  scene.prepare(Geometry::updated, true, skin);
  scene.set("velocity", random_field(s.x.size(), 3.0, seed));
}

}  // namespace

TEST_CASE("all mechanisms at once: the energy balance closes") {
  Scene scene;
  stirred(scene);
  const double dt = 0.05 * scene.engine.stable_step();
  scene.step(dt);
  const double before = scene.engine.ledger().balance();
  scene.step(dt, 3000);
  CHECK(scene.count("broken") > 20);
  for (const char* name : {"friction", "rolling", "contact_damping", "broken_bonds"})
    CHECK(scene.energy(name) > 1e-3 * before);
  CHECK(scene.engine.ledger().balance() == Approx(before).epsilon(2e-3));
}

TEST_CASE("all mechanisms at once: threads and searches give the same bits") {
  Scene one, two, often;
  stirred(one);
  stirred(two, 0.0, 2);
  stirred(often, 1e-6);
  const double dt = 0.3 * one.engine.stable_step();
  for (Scene* s : {&one, &two, &often}) s->step(dt, 40);
  CHECK(one.count("surface_contacts") > 0);
  CHECK(one.count("broken") > 20);
  CHECK(one.engine.state_hash() == two.engine.state_hash());
  CHECK(one.engine.state_hash() == often.engine.state_hash());
  for (const char* name : {"rolling", "contact_damping", "friction"}) CHECK(one.energy(name) == two.energy(name));
}

TEST_CASE("all mechanisms at once: a checkpoint resumes bit for bit") {
  Scene unbroken, first, second;
  stirred(unbroken);
  const double dt = 0.3 * unbroken.engine.stable_step();
  unbroken.step(dt, 300, 0.1);
  stirred(first);
  first.step(dt, 150, 0.1);
  stirred(second, 0.0, 1, 99);
  second.step(dt, 10);
  second.engine.restore(first.engine.checkpoint());
  second.time = first.time;
  second.step(dt, 150, 0.1);
  CHECK(second.engine.state_hash() == unbroken.engine.state_hash());
  for (const char* name : {"rolling", "contact_damping", "friction", "kinetic", "elastic"})
    CHECK(second.energy(name) == unbroken.energy(name));
}
