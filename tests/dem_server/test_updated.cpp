// Updated geometry: history, rotation, images, checkpoints, walls, trouble.

#include <numbers>

#include "fixture.hpp"
#include "tests/figure.hpp"

using namespace gabion::dem;
using namespace gabion::dem::testing;

namespace {

/// Touching spheres with friction that are stirred; some bonds break.
void stirred(Scene& scene, double skin, unsigned seed = 3, int threads = 1) {
  Spheres s = jittered(6);
  for (double& r : s.r) r *= 1.08;
  GrainMaterial material = frictional_material(0.3);
  material.normal_strength = 2e4;
  material.shear_strength = 1e4;
  scene.periodic_box(vec(-.5, -.5, -.5), vec(5.5, 5.5, 5.5));
  scene.engine.threads = threads;
  scene.grains(s.x, s.r, material);
  scene.engine.make_bonds(0.0);
  scene.prepare(Geometry::updated, true, skin);
  scene.set("velocity", random_field(s.x.size(), 3.0, seed));
}

}  // namespace

TEST_CASE("contact history survives rebuilds: every step or hardly ever") {
  Scene often, seldom;
  stirred(often, 1e-6);
  stirred(seldom, 1.5);
  const double dt = 0.3 * seldom.engine.stable_step();
  often.step(dt, 400);
  seldom.step(dt, 400);
  CHECK(often.count("rebuilds") > 390);
  CHECK(seldom.count("rebuilds") < 0.1 * often.count("rebuilds"));
  CHECK(often.count("broken") > 20);
  CHECK(often.count("sliding") > 0);
  CHECK(often.count("broken") == seldom.count("broken"));
  CHECK(often.engine.state_hash() == seldom.engine.state_hash());
  CHECK(often.energy("friction") == Approx(seldom.energy("friction")).epsilon(1e-12));
  double difference = 0.0;
  for (std::size_t i = 0; i < often.engine.motion.size(); ++i)
    difference = std::max(difference, norm(often.engine.motion.displacement[i] - seldom.engine.motion.displacement[i]));
  gabion::figure("rebuild_difference", difference);
  CHECK_THROWS_WITH(often.engine.set_contact_options({Geometry::updated, true, -0.1}), Catch::Contains("skin is"));
}

TEST_CASE("the energy balance closes while bonds break and contacts slide") {
  Scene scene;
  stirred(scene, 0.0);
  const double dt = 0.05 * scene.engine.stable_step();
  scene.step(dt);
  const double before = scene.engine.ledger().balance();
  scene.step(dt, 3000);
  CHECK(scene.count("broken") > 20);
  CHECK(scene.energy("friction") > 0.05 * before);
  CHECK(scene.energy("broken_bonds") > 0.001 * before);
  CHECK(scene.engine.ledger().balance() == Approx(before).epsilon(2e-3));
}

TEST_CASE("momentum is kept and threads give the same bits while bonds break") {
  Scene one, two;
  stirred(one, 0.0, 3, 1);
  stirred(two, 0.0, 3, 2);
  const std::vector<double> before = one.engine.momentum();
  const double dt = 0.3 * one.engine.stable_step();
  one.step(dt, 100);
  two.step(dt, 100);
  const std::vector<double> after = one.engine.momentum();
  for (int c = 0; c < 3; ++c) CHECK(after[c] == Approx(before[c]).margin(1e-12 * before[6]));
  CHECK(one.count("broken") > 20);
  CHECK(one.engine.state_hash() == two.engine.state_hash());
  CHECK(one.energy("friction") == two.energy("friction"));
}

TEST_CASE("a checkpoint resumes bit for bit") {
  Scene unbroken, first, second;
  stirred(unbroken, 0.0);
  const double dt = 0.3 * unbroken.engine.stable_step();
  unbroken.step(dt, 300, 0.1);
  stirred(first, 0.0);
  first.step(dt, 150, 0.1);
  const auto blob = first.engine.checkpoint();
  stirred(second, 0.0, 99);
  second.step(dt, 10);
  second.engine.restore(blob);
  CHECK(second.engine.state_hash() == first.engine.state_hash());
  second.time = first.time;
  second.step(dt, 150, 0.1);
  CHECK(second.engine.state_hash() == unbroken.engine.state_hash());
  for (const char* name : {"friction", "broken_bonds", "damping", "kinetic"})
    CHECK(second.energy(name) == unbroken.energy(name));
  CHECK(second.count("broken") == unbroken.count("broken"));

  auto cut = blob;
  cut.resize(blob.size() / 2);
  CHECK_THROWS_WITH(second.engine.restore(cut), Catch::Contains("too early"));
  Scene other;
  other.grains({vec(0, 0, 0), vec(2, 0, 0)}, {0.5, 0.5}, elastic_material());
  other.prepare(Geometry::updated);
  CHECK_THROWS_WITH(other.engine.restore(blob), Catch::Contains("216 grains"));
}

TEST_CASE("small motions: updated geometry is frozen geometry") {
  const Spheres s = jittered(4);
  Scene frozen, updated;
  for (Scene* scene : {&frozen, &updated}) {
    scene->periodic_box(vec(-.5, -.5, -.5), vec(3.5, 3.5, 3.5));
    scene->grains(s.x, s.r, elastic_material());
    scene->engine.make_bonds(0.35);
    scene->prepare(scene == &frozen ? Geometry::frozen : Geometry::updated);
    scene->set("displacement", random_field(s.x.size(), 1e-9, 5));
    scene->set("rotation", random_field(s.x.size(), 1e-9, 6));
    scene->set("velocity", random_field(s.x.size(), 1e-7, 7));
    scene->set("spin", random_field(s.x.size(), 1e-7, 8));
  }
  const double dt = 0.2 * frozen.engine.stable_step();
  frozen.step(dt, 500);
  updated.step(dt, 500);
  double difference = 0.0, size = 0.0;
  for (std::size_t i = 0; i < s.x.size(); ++i) {
    difference =
        std::max(difference, norm(frozen.engine.motion.displacement[i] - updated.engine.motion.displacement[i]));
    size = std::max(size, norm(frozen.engine.motion.displacement[i]));
  }
  CHECK(difference < 1e-6 * size);
  CHECK(updated.energy("elastic") == Approx(frozen.energy("elastic")).epsilon(1e-6));
  CHECK(updated.energy("kinetic") == Approx(frozen.energy("kinetic")).epsilon(1e-6));
}

TEST_CASE("a packing that turns as a whole keeps its shear springs and makes no others") {
  // a bonded pair and a third grain: spinning rigidly, first stress-free
  const Spheres s{{vec(0, 0, 0), vec(1, 0, 0), vec(0.4, 0.9, 0)}, {0.5, 0.5, 0.5}};
  Scene scene;
  scene.grains(s.x, s.r, elastic_material());
  scene.engine.make_bonds(0.1);
  scene.prepare(Geometry::updated);
  // slow enough that the centrifugal stretch is small; three turns
  const double spin = 1e-3 * 2.0 / scene.engine.stable_step();
  Vec centre{};
  for (const Vec x : s.x) centre += x / splat(3.0);
  VecField v, w;
  const Vec omega = vec(0.3, 0.5, 0.81) * splat(spin);
  for (const Vec x : s.x) v.push_back(cross(omega, x - centre)), w.push_back(omega);
  scene.set("velocity", v);
  scene.set("spin", w);
  const double dt = 0.2 * scene.engine.stable_step();
  scene.step(dt);
  const double total = scene.engine.ledger().balance();
  scene.step(dt, static_cast<int>(3 * 2 * std::numbers::pi / norm(omega) / dt));
  // centrifugal force stretches; a frame that turned wrongly would store orders more
  CHECK(scene.energy("elastic") < 1e-4 * total);
  CHECK(scene.engine.ledger().balance() == Approx(total).epsilon(1e-5));
}

TEST_CASE("a grain that meets its own image") {
  // a chain of one grain: it may move freely along, and feels no force from its image
  Scene scene;
  scene.engine.options.box_hi = vec(1, 10, 10);
  scene.engine.options.periodic[0] = true;
  scene.grains({vec(0.3, 5, 5)}, {0.5}, elastic_material());
  CHECK(scene.engine.make_bonds(0.0).bonds == 1);
  for (const Geometry geometry : {Geometry::frozen, Geometry::updated}) {
    scene.prepare(geometry);
    scene.set("displacement", {vec(0, 0, 0)});
    scene.set("rotation", {vec(0, 0, 0)});
    scene.set("velocity", {vec(0.1, 0.2, 0)});
    scene.set("spin", {vec(0, 0, 0.1)});
    const double k = 0.5 * elastic_material().shear_stiffness * 0.5;
    // the bond to the image holds the rotation: I theta'' = -k_s (a_i + a_j)^2 theta
    const double inertia = scene.engine.rotation().inertia[0];
    const double omega = std::sqrt(k / inertia);
    const double dt = 0.01 / omega;
    scene.step(dt, 200);
    CHECK(scene.velocity(0)[0] == Approx(0.1));
    CHECK(scene.velocity(0)[1] == Approx(0.2));
    CHECK(scene.spin(0)[2] == Approx(0.1 * std::cos(omega * 199.5 * dt)).margin(2e-3));
  }
}

TEST_CASE("grains cross a periodic side") {
  Scene scene;
  scene.periodic_box(vec(0, 0, 0), vec(4, 4, 4));
  scene.grains({vec(0.6, 2, 2), vec(3.0, 2, 2)}, {0.5, 0.5}, frictional_material(0.0));
  scene.prepare(Geometry::updated);
  scene.set("velocity", {vec(-1, 0, 0), vec(1, 0, 0)});
  const double dt = 0.05 * scene.engine.stable_step();
  scene.step(dt, static_cast<int>(1.0 / dt));
  CHECK(scene.velocity(0)[0] == Approx(1.0).epsilon(1e-3));
  CHECK(scene.velocity(1)[0] == Approx(-1.0).epsilon(1e-3));
}

TEST_CASE("a small grain between two large ones holds by friction up to its cone (size ratio 20)") {
  // two plates of large spheres press a small one; its weight is below and above 2 mu N
  const double R = 1.0, r = 0.05, mu = 0.3, press = 50.0;
  for (const double share : {0.9, 1.1}) {
    Scene scene;
    scene.grains({vec(0, 0, 0), vec(2 * (R + r) / 2, 0, 0), vec(2 * (R + r), 0, 0)}, {R, r, R},
                 frictional_material(mu));
    using gabion::engine::History;
    scene.engine.boundary.add({"left", {0}, 15, vec(0, 0, 0), {}}, 3);
    scene.engine.boundary.add({"right", {2}, 14, vec(0, 0, 0), {}}, 3);
    scene.engine.boundary.add({"roll", {1}, 8, vec(0, 0, 0), {}}, 3);
    scene.engine.boundary.add({"press", {2}, {vec(-press, 0, 0)}, History("constant", {1.0})}, 3);
    scene.engine.boundary.add({"pull", {1}, {vec(0, 0, -share * 2 * mu * press)}, History("ramp", {1.0, 20.0, 10.0})},
                              3);
    scene.prepare(Geometry::updated);
    const double dt = 0.5 * scene.engine.stable_step();
    double fall = 0.0;
    while (scene.time < 35.0 && fall < 0.6 * r) {
      scene.step(dt, 10, 0.6);
      fall = -scene.engine.motion.displacement[1][2];
    }
    gabion::figure(share < 1.0 ? "held_fall" : "beyond_fall", fall / r);
    if (share < 1.0)
      CHECK(fall < 0.05 * r);
    else
      CHECK(fall > 0.5 * r);
  }
}

TEST_CASE("walls press, rub and move, and the balance closes") {
  Scene scene;
  scene.engine.options.gravity = vec(0, 0, -1);
  scene.grains({vec(0, 0, 0.5)}, {0.5}, frictional_material(0.4));
  Wall floor{vec(0, 0, 0), vec(0, 0, 1), 0.4, vec(0.5, 0, 0), {}, {}};
  Wall lid{vec(0, 0, 1.01), vec(0, 0, -1), 0.2, vec(0, 0, -0.2), {}, {}};
  scene.engine.set_walls({floor, lid});
  scene.prepare(Geometry::updated);
  const double dt = 1e-4;
  REQUIRE(dt < 0.02 * scene.engine.stable_step());
  scene.step(dt);
  const double before = scene.engine.ledger().balance();
  scene.step(dt, 1500);
  CHECK(scene.count("surface_contacts") == 2);
  double largest = 0.0;
  const auto ledger = scene.engine.ledger();
  for (const auto& entry : ledger.entries) largest = std::max(largest, std::fabs(entry.energy));
  CHECK(std::fabs(scene.energy("walls")) > 0.1 * largest);
  CHECK(scene.energy("friction") > 0.0);
  CHECK(std::fabs(scene.engine.ledger().balance() - before) < 2e-3 * largest);
}

TEST_CASE("weights scale forces and masses, not frequencies") {
  const Spheres s = jittered(5);
  const auto make = [&](Scene& scene, double width) {
    scene.grains(s.x, s.r, elastic_material());
    scene.engine.make_bonds(0.35);
    scene.engine.weights.outer_lo[2] = -0.5;
    scene.engine.weights.width = width;
    scene.engine.weights.floor = 0.01;
    scene.prepare(Geometry::frozen);
  };
  Scene plain, weighted;
  make(plain, 0.0);
  make(weighted, 4.0);
  CHECK(weighted.engine.stable_step() > 0.97 * plain.engine.stable_step());
  std::vector<std::uint64_t> shape;
  const auto w = *weighted.engine.field("weight", shape);
  REQUIRE(shape == std::vector<std::uint64_t>{125});
  CHECK(w[0] < 0.2);
  CHECK(w[124] > 0.9);
  // a bond's force is w at its contact point times the plain one
  for (Scene* scene : {&plain, &weighted}) scene->set("displacement", random_field(125, 1e-4, 2));
  const auto f = *plain.engine.field("contact", shape), g = *weighted.engine.field("contact", shape);
  for (std::size_t c = 0; c < shape[0]; ++c) {
    const auto i = static_cast<std::size_t>(f[8 * c]), j = static_cast<std::size_t>(f[8 * c + 1]);
    const Vec n = vec(f[8 * c + 2], f[8 * c + 3], f[8 * c + 4]);
    const double d = norm(s.x[j] - s.x[i]);
    const Vec point = s.x[i] + n * splat(0.5 * (d + s.r[i] - s.r[j]));
    const double at = std::fmin(1.0, std::fmax(0.01, (point[2] + 0.5) / 4.0));
    for (int k = 5; k < 8; ++k) CHECK(g[8 * c + k] == Approx(at * f[8 * c + k]).margin(1e-9));
  }
}

TEST_CASE("the same scene far from the origin") {
  const Spheres s = jittered(4);
  VecField u[2];
  for (const int far : {0, 1}) {
    Spheres moved = s;
    // a power of two keeps the places exact to the spacing of numbers there
    for (Vec& x : moved.x) x += vec(1048576, -1048576, 1048576) * splat(far);
    Scene scene;
    scene.grains(moved.x, s.r, elastic_material());
    scene.engine.make_bonds(0.35);
    scene.prepare(Geometry::updated);
    scene.set("velocity", random_field(64, 1e-3, 2));
    scene.step(0.5 * scene.engine.stable_step() * 0 + 1e-4, 200);
    u[far] = scene.engine.motion.displacement;
  }
  double size = 0.0, difference = 0.0;
  for (std::size_t i = 0; i < 64; ++i) {
    size = std::max(size, norm(u[0][i]));
    difference = std::max(difference, norm(u[1][i] - u[0][i]));
  }
  CHECK(difference < 1e-8 * size);
}

TEST_CASE("trouble is named") {
  Scene scene;
  scene.grains({vec(0, 0, 0), vec(0.7, 0, 0)}, {0.5, 0.5}, frictional_material(0.1));
  CHECK_THROWS_WITH(scene.prepare(Geometry::updated), Catch::Contains("grains 0 and 1 overlap"));

  Scene flying;
  flying.engine.options.box_hi = vec(2, 2, 2);
  flying.grains({vec(0.5, 1, 1), vec(1.6, 1, 1)}, {0.5, 0.5}, frictional_material(0.1));
  flying.prepare(Geometry::updated);
  flying.set("velocity", {vec(-1, 0, 0), vec(0, 0, 0)});
  flying.step(0.01, 300);
  CHECK(flying.count("lost") == 1);
  std::vector<std::uint64_t> shape;
  CHECK(*flying.engine.field("lost", shape) == std::vector<double>{1, 0});

  flying.set("velocity", {vec(-100, 0, 0), vec(0, 0, 0)});
  CHECK_THROWS_WITH(flying.step(0.01, 3), Catch::Contains("more than its radius"));

  Scene sick;
  sick.grains({vec(0, 0, 0), vec(1.1, 0, 0)}, {0.5, 0.5}, frictional_material(0.1));
  sick.prepare(Geometry::updated);
  sick.engine.motion.velocity[1][0] = NAN;
  try {
    sick.step(1e-3, 2);
    FAIL("not detected");
  } catch (const gabion::engine::PhysicsError& error) {
    CHECK(error.where == "grain 1");
  }
  CHECK_THROWS_WITH(sick.engine.set_field("force", {}), Catch::Contains("no field"));
  CHECK_THROWS_WITH(sick.set("velocity", {vec(0, 0, 0)}), Catch::Contains("3 values for 2"));
}

TEST_CASE("yield says how many contacts slide or are broken, and what the others use of their strength") {
  std::vector<std::uint64_t> shape;
  const double r = 0.5, friction = 0.5;
  const auto pressed = [&](double sideways) {
    auto scene = std::make_unique<Scene>();
    scene->grains({vec(0, 0, 0), vec(0.99, 0, 0)}, {r, r}, frictional_material(friction));
    scene->prepare(Geometry::updated, false);
    scene->set("velocity", {Vec{}, vec(0, sideways, 0)});
    scene->step(1e-4, 20);
    return scene;
  };
  const auto held = pressed(0.2);
  const auto f = *held->engine.field("contact", shape);
  REQUIRE(shape[0] == 1);
  const Vec n = vec(f[2], f[3], f[4]), force = vec(f[5], f[6], f[7]);
  const double normal = std::fabs(dot(force, n)), shear = norm(force - splat(dot(force, n)) * n);
  REQUIRE(shear > 0.01 * friction * normal);
  auto yield = *held->engine.field("yield", shape);
  REQUIRE(shape == std::vector<std::uint64_t>{2, 3});
  for (const std::size_t g : {0, 1}) {
    CHECK(yield[3 * g] == 1.0);
    CHECK(yield[3 * g + 1] == 0.0);
    CHECK(yield[3 * g + 2] == Approx(shear / (friction * normal)).epsilon(0.02));
  }
  yield = *pressed(20.0)->engine.field("yield", shape);
  CHECK(yield == std::vector<double>{1, 1, 0, 1, 1, 0});  // slides

  // a bond at half its strength, and beyond it
  GrainMaterial bonds = frictional_material(friction);
  bonds.normal_strength = bonds.shear_strength = 1e4;
  const double strength = bonds.normal_strength * r * r, stiffness = 0.5 * bonds.normal_stiffness * r;
  for (const double share : {0.5, 1.5}) {
    Scene scene;
    scene.grains({vec(0, 0, 0), vec(1, 0, 0)}, {r, r}, bonds);
    scene.engine.make_bonds(0.0);
    scene.prepare(Geometry::updated);
    scene.set("displacement", {Vec{}, vec(share * strength / stiffness, 0, 0)});
    scene.step(1e-6, 2);
    yield = *scene.engine.field("yield", shape);
    CHECK(yield[0] == 1.0);
    CHECK(yield[1] == (share > 1.0 ? 1.0 : 0.0));
    CHECK(yield[2] == Approx(share > 1.0 ? 0.0 : share).epsilon(1e-3));
  }
}
