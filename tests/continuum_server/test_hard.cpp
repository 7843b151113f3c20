// Hard cases of the mesh alone: numbers that are none, denormals.

#include <catch2/catch.hpp>

#include "solid_fixture.hpp"
#include "tests/denormals.hpp"
#include "tests/figure.hpp"

using namespace gabion;
using namespace gabion::continuum;
using engine::vec;

TEST_CASE("a node that is no number is named in the step in which it becomes so") {
  for (const int threads : {1, 2})
    for (const double value : {NAN, INFINITY}) {
      Solid solid(box_mesh({6, 6, 20}, vec(6, 6, 20)), isotropic(1e6, 0.3, 1000.0), false);
      solid.engine.threads = threads;
      solid.engine.prepare();
      const double dt = 0.5 * solid.engine.stable_step();
      solid.engine.step({0.0, dt, 0.0, false}, solid.nobody);
      solid.engine.motion.velocity[700][1] = value;
      try {
        solid.engine.step({dt, dt, 0.0, false}, solid.nobody);  // not a measured one
        FAIL("not detected");
      } catch (const engine::PhysicsError& error) {
        CHECK(error.where == "node 700");
      }
      std::vector<double> values(3 * solid.engine.motion.size(), 0.0);
      values[3 * 12 + 2] = value;
      CHECK_THROWS_WITH(solid.engine.set_field("velocity", values), Catch::Contains("node 12 is not finite"));
    }
  figure("steps_until_nan_is_named", 1);
}

TEST_CASE("denormals never appear ahead of a wave") {
  std::size_t found = 0;
  double smallest = 1.0;
  for (const int threads : {1, 2}) {
    Solid solid(box_mesh({2, 2, 120}, vec(2, 2, 120)), isotropic(1e6, 0.3, 1000.0));
    solid.engine.threads = threads;
    solid.engine.prepare();
    solid.set(solid.engine.motion.velocity, [](Vec x) { return vec(0, 0, x[2] == 0.0 ? 1e-200 : x[2] == 120.0 ? 1e-310 : 0.0); });
    const double dt = 0.5 * solid.engine.stable_step();
    for (int k = 0; k < 100; ++k) {
      solid.run(1, dt);
      found += denormals(solid.engine.motion.velocity) + denormals(solid.engine.motion.displacement) +
               denormals(solid.engine.motion.force);
    }
    for (const Vec v : solid.engine.motion.velocity)
      for (int axis = 0; axis < 3; ++axis)
        if (v[axis] != 0.0) smallest = std::min(smallest, std::fabs(v[axis]));
  }
  CHECK(found == 0);
  CHECK(smallest < 1e-280);  // the tail ahead of the wave has come down to where its forces are denormal
  figure("denormals_in_mesh", static_cast<double>(found));
}
