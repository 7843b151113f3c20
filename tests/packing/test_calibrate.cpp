#include <catch2/catch.hpp>

#include "dem_server/packing/calibrate.hpp"
#include "dem_server/packing/packing.hpp"
#include "protocol/engine/engine.hpp"

using namespace gabion::dem;

namespace {

PackingRequest small_request() {
  PackingRequest request;
  request.box = {vec(0, 0, 0), vec(1, 1, 1), {true, true, true}};
  request.radius = {0.04, 0.08};
  request.contacts_per_grain = 6.0;
  return request;
}

}  // namespace

TEST_CASE("calibrated coefficients give the wanted E and nu") {
  const PackingRequest request = small_request();
  const Packing packing = make_packing(request);
  const Window whole{request.box.lo, request.box.hi};
  for (const CalibrationTarget target : {CalibrationTarget{500e6, 0.25}, CalibrationTarget{196e6, 0.15}}) {
    const Calibration found = calibrate(packing.position, packing.radius, packing.gap, request.box, whole, target);
    REQUIRE(found.in_reach);
    const Homogenised check = homogenise(
        make_bond_network(packing.position, packing.radius, request.box, packing.gap, {{found.normal}, {found.shear}}),
        request.box, whole);
    CHECK(check.isotropic.young == Approx(target.young).epsilon(1e-6));
    CHECK(check.isotropic.poisson == Approx(target.poisson).margin(2e-4));
    CHECK(found.poisson == Approx(check.isotropic.poisson).margin(1e-6));
  }
}

TEST_CASE("a Poisson's ratio out of reach is said to be so, and the nearest end is taken") {
  const PackingRequest request = small_request();
  const Packing packing = make_packing(request);
  const Window whole{request.box.lo, request.box.hi};
  CalibrationOptions options;
  options.least_ratio = 0.2;
  const Calibration high =
      calibrate(packing.position, packing.radius, packing.gap, request.box, whole, {1e8, 0.45}, options);
  CHECK_FALSE(high.in_reach);
  CHECK(high.shear / high.normal == Approx(0.2));
  CHECK(high.poisson == high.poisson_at_least_ratio);
  const Calibration low = calibrate(packing.position, packing.radius, packing.gap, request.box, whole, {1e8, -0.3});
  CHECK_FALSE(low.in_reach);
  CHECK(low.shear / low.normal == Approx(1.0));
  CHECK_THROWS_AS(calibrate(packing.position, packing.radius, packing.gap, request.box, whole, {-1.0, 0.2}),
                  gabion::engine::RequestError);
}
