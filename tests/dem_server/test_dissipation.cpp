// Rolling resistance, contact damping and locked grains together: momentum, energy, weights, checkpoints, threads.

#include "fixture.hpp"

using namespace gabion::dem;
using namespace gabion::dem::testing;

namespace {

constexpr double r = 0.5;

GrainMaterial rolling(double beta, double eta, double friction = 10.0) {
  GrainMaterial m = frictional_material(friction);
  m.rolling_stiffness = beta;
  m.rolling_friction = eta;
  return m;
}

}  // namespace

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
  for (const auto& [change, word] : {std::pair{+[](GrainMaterial& m) { m.restitution = 0.0; }, "restitution"},
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
