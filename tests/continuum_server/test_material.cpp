#include <catch2/catch.hpp>

#include "continuum_server/material.hpp"
#include "protocol/engine/engine.hpp"

using namespace gabion::continuum;
using gabion::engine::RequestError;

TEST_CASE("isotropic stiffness of the compression scene has its P-wave modulus") {
  const SolidMaterial soil = isotropic(500e6, 0.32, 1700.0);
  CHECK(soil.stiffness[0] == Approx(715.5e6).epsilon(1e-4));
  CHECK(soil.stiffness[21] == Approx(500e6 / 2.64).epsilon(1e-14));
  CHECK_NOTHROW(check(soil, 0));
}

TEST_CASE("a material that makes no sense is refused by name") {
  SolidMaterial soil = isotropic(1.0, 0.3, 1.0);
  const auto where = [&] {
    try {
      check(soil, 3);
    } catch (const RequestError& error) {
      return error.where;
    }
    return std::string("accepted");
  };
  SECTION("density") {
    soil.density = 0.0;
    CHECK(where() == "SOLID_MATERIALS[3].density");
  }
  SECTION("not a number") {
    soil.stiffness[7] = std::nan("");
    CHECK(where() == "SOLID_MATERIALS[3].stiffness");
  }
  SECTION("not symmetric") {
    soil.stiffness[1] *= 1.01;
    CHECK(where() == "SOLID_MATERIALS[3].stiffness");
  }
  SECTION("not positive definite") {
    soil = isotropic(1.0, 0.51, 1.0);
    CHECK(where() == "SOLID_MATERIALS[3].stiffness");
  }
}

TEST_CASE("free strains leave the plane-stress and the uniaxial stiffness of an isotropic material") {
  const double young = 3.0, poisson = 0.3;
  const BrickStiffness brick = brick_stiffness(isotropic(young, poisson, 1.0));
  for (int axis = 0; axis < 3; ++axis) {
    CHECK(3 * brick.linear[axis][0][0] == Approx(young / (1 - poisson * poisson)).epsilon(1e-13));
    CHECK(3 * brick.linear[axis][0][1] == Approx(young * poisson / (1 - poisson * poisson)).epsilon(1e-13));
    CHECK(9 * brick.bilinear[axis][0][0] == Approx(young).epsilon(1e-13));
    CHECK(9 * brick.bilinear[axis][1][1] == Approx(young / (2 * (1 + poisson))).epsilon(1e-13));
  }
}
