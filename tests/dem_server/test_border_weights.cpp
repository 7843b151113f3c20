// Weights at an edge-to-edge border: shares of lines, masses, forces, the stable step.

#include "fixture.hpp"

using namespace gabion::dem;
using namespace gabion::dem::testing;
using gabion::engine::vec;
using gabion::engine::WeightField;

TEST_CASE("a line counts with its share inside the outer box") {
  WeightField border;
  CHECK_FALSE(border.border());
  border.outer_hi[2] = 1.0;
  border.floor = 0.01;
  REQUIRE(border.border());
  CHECK(border.share_of_line(vec(0, 0, 0), vec(0, 0, 0.5)) == 1.0);
  CHECK(border.share_of_line(vec(0, 0, 0), vec(3, 0, 4)) == Approx(0.25));
  CHECK(border.share_of_line(vec(3, 0, 4), vec(-3, 0, -4)) == Approx(0.25));
  CHECK(border.share_of_line(vec(0, 0, 2), vec(1, 1, 1)) == 0.01);
  CHECK(border.share_of_line(vec(0, 0, 1), vec(1, 0, 0)) == 0.5);
  CHECK(border.share_of_line(vec(0, 0, 1 - 1e-9), vec(1, 0, 1e-9)) == 0.5);
  CHECK(border.share_of_line(vec(0, 0, 0.9), vec(1, 0, 0)) == 1.0);
  CHECK(border.share_of_line(vec(0, 0, 1.1), vec(1, 0, 0)) == 0.01);
  border.outer_hi[0] = 1.0;
  CHECK(border.share_of_line(vec(0, 0, 0), vec(2, 0, 4)) == Approx(0.25));
  CHECK(border.share_of_line(vec(0, 0, 0), vec(4, 0, 2)) == Approx(0.25));
  border.width = 2.0;
  CHECK_FALSE(border.border());
}

TEST_CASE("at a border forces follow the bond's share and masses the mean share") {
  // three grains in a line along z, the border at a quarter of the second bond
  const double r = 0.5;
  const auto build = [&](Scene& scene, bool border) {
    if (border) {
      scene.engine.weights.outer_hi[2] = 1.25;
      scene.engine.weights.floor = 0.01;
    }
    scene.grains({vec(0, 0, 0), vec(0, 0, 1), vec(0, 0, 2)}, {r, r, r}, elastic_material());
    scene.engine.make_bonds(0.0);
    scene.prepare(Geometry::frozen, false);
  };
  Scene plain, weighted;
  build(plain, false);
  build(weighted, true);
  const double mass = plain.engine.motion.mass[0];
  CHECK(weighted.engine.motion.mass[0] == Approx(mass));
  CHECK(weighted.engine.motion.mass[1] == Approx(mass * 0.5 * (1.0 + 0.25)));
  CHECK(weighted.engine.motion.mass[2] == Approx(mass * 0.25));
  for (Scene* scene : {&plain, &weighted}) {
    scene->set("displacement", {vec(0, 0, 0), vec(0, 0, 0), vec(0, 0, 1e-6)});
    scene->step(1e-9);
  }
  CHECK(weighted.engine.motion.force[2][2] == Approx(0.25 * plain.engine.motion.force[2][2]));
  CHECK(weighted.engine.stable_step() >= 0.999 * plain.engine.stable_step());
}

TEST_CASE("a pair that nearly touches across the border costs no stable step") {
  // the upper grain hangs on a bond that hardly counts, and nearly touches one below the border
  const double r = 0.5, gap = 0.01;
  const auto limit = [&](bool border) {
    Scene scene;
    if (border) {
      scene.engine.weights.outer_hi[2] = 0.9;
      scene.engine.weights.floor = 0.01;
    }
    scene.grains({vec(0, 0, 0), vec(0, 0, 1 + gap), vec(1, 0, 1 + gap), vec(1, 0, 0)}, {r, r, r, r}, elastic_material());
    scene.engine.make_bonds(1e-6);
    scene.prepare(Geometry::updated, false);
    return scene.engine.stable_step();
  };
  CHECK(limit(true) >= 0.9 * limit(false));
}

TEST_CASE("a grain thrown out of the pure zone lands on a light one of the overlap or border without a jolt") {
  const double r = 0.5, fall = 0.5, dt = 0.03;
  for (const bool bridging : {true, false}) {
    INFO((bridging ? "bridging" : "border"));
    const double height = bridging ? 0.1 : -0.39;
    Scene scene;
    scene.engine.weights.outer_lo[2] = bridging ? 0.0 : 0.1;
    scene.engine.weights.width = bridging ? 5.0 : 0.0;
    scene.engine.weights.floor = 0.02;
    // the light one has a bond to a neighbour beside it, along the border
    scene.grains({vec(0, 0, 12), vec(0, 0, height), vec(2 * r, 0, height)}, {r, r, r}, elastic_material());
    scene.engine.make_bonds(0.0);
    scene.prepare(Geometry::updated);
    const double heavy = scene.engine.motion.mass[0], light = scene.engine.motion.mass[1];
    REQUIRE(light < 0.05 * heavy);
    // set down above the light one: at rest the two are 12 m apart
    scene.set("displacement", {vec(0, 0, height + 2 * r + 0.05 - 12), Vec{}, Vec{}});
    scene.engine.prepare();
    scene.set("velocity", {vec(0, 0, -fall), Vec{}, Vec{}});
    const double before = 0.5 * heavy * fall * fall;
    double fastest = 0.0;
    for (int k = 0; k < 60; ++k) {
      scene.step(dt);
      for (std::size_t g = 0; g < 3; ++g) fastest = std::max(fastest, norm(scene.velocity(g)));
    }
    CHECK(fastest > 1.5 * fall);  // they did meet
    CHECK(fastest < 2.5 * fall);  // a light body leaves a heavy one at most twice as fast as that came
    CHECK(scene.velocity(0)[2] == Approx(-fall).epsilon(0.1));
    CHECK(scene.engine.ledger().balance() == Approx(before).epsilon(0.01));
  }
}
