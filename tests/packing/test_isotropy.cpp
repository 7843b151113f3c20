#include <catch2/catch.hpp>

#include "dem_server/packing/isotropy.hpp"

using namespace gabion::dem;

TEST_CASE("an isotropic stiffness is its own isotropic part") {
  const Isotropic part = isotropic_part(isotropic_stiffness(500e6, 0.32));
  CHECK(part.young == Approx(500e6).epsilon(1e-12));
  CHECK(part.poisson == Approx(0.32).epsilon(1e-12));
  CHECK(part.misfit < 1e-14);
  CHECK(isotropic_stiffness(500e6, 0.32)(0, 0) == Approx(715.49e6).epsilon(1e-4));
}

TEST_CASE("cubic stiffness: bulk modulus kept, shear modulus 2/5 and 3/5 of its two, misfit of the rest") {
  Stiffness c = Stiffness::Zero();
  c.topLeftCorner<3, 3>().setConstant(1.0);
  c.diagonal() << 3.0, 3.0, 3.0, 2.0, 2.0, 2.0;  // shear moduli (c11 - c12)/2 = 1, twice, and c44 = 2, thrice
  const Isotropic part = isotropic_part(c);
  CHECK(part.bulk == Approx(5.0 / 3.0));
  CHECK(part.shear == Approx(0.4 * 1.0 + 0.6 * 2.0));
  // eigenvalues as a tensor: 5 once, 2 twice, 4 thrice; the isotropic part has 3.2 five times
  CHECK(part.misfit == Approx(std::sqrt((2 * 1.2 * 1.2 + 3 * 0.8 * 0.8) / (25 + 8 + 48))));
}
