// Bridging weights on the mesh.

#include <catch2/catch.hpp>
#include <numeric>

#include "solid_fixture.hpp"

using namespace gabion::continuum;
namespace engine = gabion::engine;
using engine::vec;

namespace {

/// A column along x from 0 to 8 m; grains lie below x = 6 m, the overlap is 4 m wide.
struct Bridged : Solid {
  Bridged() : Solid(box_mesh({8, 1, 1}, vec(8, 1, 1)), isotropic(1e6, 0.3, 1000.0)) {
    engine.weights = {vec(-INFINITY, -INFINITY, -INFINITY), vec(6, INFINITY, INFINITY), 4.0, 0.01};
    engine.options.gravity = vec(0, 0, -10.0);
  }
};

}  // namespace

TEST_CASE("elements take one minus the grains' weight at their centre, never below the floor") {
  Bridged solid;
  solid.engine.prepare();
  const double expected[8] = {0.01, 0.01, 0.125, 0.375, 0.625, 0.875, 1.0, 1.0};
  const auto share = solid.values("element_weight");
  for (int e = 0; e < 8; ++e) CHECK(share[e] == Approx(expected[e]).epsilon(1e-14));
  const auto mass = solid.values("mass"), plain = solid.values("plain_mass");
  CHECK(std::accumulate(plain.begin(), plain.end(), 0.0) == Approx(8000.0).epsilon(1e-14));
  CHECK(mass[4] == Approx(125.0 * (0.375 + 0.625)).epsilon(1e-14));
  CHECK(mass[8] == Approx(125.0).epsilon(1e-14));
}

TEST_CASE("the body load is weighted point by point, not element by element") {
  Bridged solid;
  solid.engine.prepare();
  solid.run(1, 1e-9);
  const auto force = solid.values("force");
  // linear weight: the integral of (1 - w) N over the hat of node x = 4 m is 1/2, of x = 6 m 1 - 1/24, of x = 2 m 1/24
  const double per_metre = -1000.0 * 10.0 / 4;
  CHECK(force[3 * 4 + 2] == Approx(per_metre * 0.5).epsilon(1e-12));
  CHECK(force[3 * 6 + 2] == Approx(per_metre * (1.0 - 1.0 / 24)).epsilon(1e-12));
  CHECK(force[3 * 2 + 2] == Approx(per_metre / 24).epsilon(1e-12));
  CHECK(force[3 * 1 + 2] == Approx(0.0).margin(1e-9));
}

TEST_CASE("stiffness carries the weight, stress does not") {
  Bridged solid;
  solid.engine.prepare();
  Solid plain(box_mesh({8, 1, 1}, vec(8, 1, 1)), isotropic(1e6, 0.3, 1000.0));
  plain.engine.prepare();
  CHECK(solid.engine.element_stiffness(3)[0] == Approx(0.375 * plain.engine.element_stiffness(3)[0]).epsilon(1e-14));
  for (Solid* each : {static_cast<Solid*>(&solid), &plain})
    each->set(each->engine.motion.displacement, [](Vec x) { return vec(1e-3 * x[0], 0, 0); });
  CHECK(solid.values("stress") == plain.values("stress"));
}

TEST_CASE("a body without weights carries all of itself") {
  Solid solid(box_mesh({2, 1, 1}, vec(2, 1, 1)), isotropic(1e6, 0.3, 1000.0));
  solid.engine.weights.floor = 0.01;
  solid.engine.prepare();
  CHECK(solid.values("element_weight") == std::vector<double>{1.0, 1.0});
}
