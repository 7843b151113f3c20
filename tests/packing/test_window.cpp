#include <catch2/catch.hpp>
#include <numbers>

#include "dem_server/packing/homogeneity.hpp"
#include "dem_server/packing/window.hpp"
#include "protocol/engine/engine.hpp"
#include "tests/packing/lattices.hpp"

using namespace gabion::dem;

namespace {

constexpr double unit_sphere = 4.0 / 3.0 * std::numbers::pi;
const Domain open_space;

}  // namespace

TEST_CASE("branches are clipped by the window") {
  const Cutter cutter({vec(0, 0, 0), vec(1, 1, 1)}, open_space);
  CHECK(cutter.share_of_branch(vec(0.2, 0.2, 0.2), vec(0.5, 0.5, 0)) == 1.0);
  CHECK(cutter.share_of_branch(vec(0.5, 0.5, 0.5), vec(2, 0, 0)) == Approx(0.25));
  CHECK(cutter.share_of_branch(vec(-1, 0.5, 0.5), vec(4, 0, 0)) == Approx(0.25));
  CHECK(cutter.share_of_branch(vec(-0.5, 0, 0.5), vec(1, 1, 0)) == Approx(0.5));
  CHECK(cutter.share_of_branch(vec(2, 2, 2), vec(1, 0, 0)) == 0.0);
}

TEST_CASE("branches over a period are counted on both sides") {
  Domain domain{vec(0, 0, 0), vec(4, 4, 4), {true, true, false}};
  const Cutter cutter({vec(0, 0, 0), vec(1, 4, 4)}, domain);
  CHECK(cutter.share_of_branch(vec(3.5, 1, 1), vec(1, 0, 0)) == Approx(0.5));
  CHECK(cutter.share_of_branch(vec(0.5, 1, 1), vec(-1, 0, 0)) == Approx(0.5));
  CHECK(cutter.share_of_branch(vec(0.5, 3.9, 1), vec(0, 1, 0)) == 1.0);
  CHECK(cutter.share_of_branch(vec(0.5, 3.9, 3.5), vec(0, 0, 1)) == Approx(0.5));
  CHECK_THROWS_AS(Cutter({vec(-1, 0, 0), vec(1, 4, 4)}, domain), gabion::engine::RequestError);
}

TEST_CASE("parts of a sphere in a window") {
  const Cutter cutter({vec(0, 0, 0), vec(4, 4, 4)}, open_space);
  CHECK(cutter.volume_of_sphere(vec(2, 2, 2), 1.0) == Approx(unit_sphere).epsilon(1e-14));
  CHECK(cutter.volume_of_sphere(vec(0, 2, 2), 1.0) == Approx(unit_sphere / 2).epsilon(1e-14));
  CHECK(cutter.volume_of_sphere(vec(0.5, 2, 2), 1.0) ==
        Approx(std::numbers::pi * (2.0 / 3.0 + 0.5 - 0.125 / 3.0)).epsilon(1e-14));
  CHECK(cutter.volume_of_sphere(vec(0, 0, 2), 1.0) == Approx(unit_sphere / 4).epsilon(1e-3));
  CHECK(cutter.volume_of_sphere(vec(0, 4, 0), 1.0) == Approx(unit_sphere / 8).epsilon(1e-3));
  CHECK(cutter.volume_of_sphere(vec(5.5, 2, 2), 1.0) == 0.0);
}

TEST_CASE("windows that fill a periodic box hold all of its spheres") {
  const lattice::Lattice fcc = lattice::face_centred_cubic(3, true);
  const double dense = std::numbers::pi / (3.0 * std::sqrt(2.0));
  CHECK(solid_fraction(fcc.centres, fcc.radii, fcc.box, {fcc.box.lo, fcc.box.hi}) == Approx(dense).epsilon(1e-13));
  double sum = 0.0;
  for (int k = 0; k < 8; ++k) {
    Window part{fcc.box.lo, fcc.box.hi};
    for (int a = 0; a < 3; ++a) ((k >> a & 1) != 0 ? part.lo : part.hi)[a] = 0.41 * fcc.box.hi[a];
    sum += solid_fraction(fcc.centres, fcc.radii, fcc.box, part) * part.volume();
  }
  CHECK(sum / Window{fcc.box.lo, fcc.box.hi}.volume() == Approx(dense).epsilon(3e-4));
}

TEST_CASE("slices of a box hold all of its spheres, also those over a periodic face") {
  for (const bool periodic : {false, true}) {
    lattice::Lattice cubic = lattice::simple_cubic(4, periodic);
    if (periodic)
      for (Vec& x : cubic.centres) x += vec(0.3, 0.7, -0.9);
    for (int axis = 0; axis < 3; ++axis) {
      const std::vector<double> slices = slice_fractions(cubic.centres, cubic.radii, cubic.box, axis, 8);
      double mean = 0.0;
      for (const double s : slices) mean += s / 8.0;
      CHECK(mean == Approx(std::numbers::pi / 6.0).epsilon(1e-12));
    }
  }
}

TEST_CASE("the fabric of a cubic lattice is isotropic, that of a column is not") {
  const lattice::Lattice cubic = lattice::simple_cubic(4, true);
  const auto fabric = fabric_tensor(cubic.centres, cubic.radii, cubic.box, 0.01);
  for (int k = 0; k < 6; ++k) CHECK(fabric[k] == Approx(k < 3 ? 1.0 / 3.0 : 0.0).margin(1e-14));
  const VecField column{vec(0, 0, 0), vec(0, 0, 2), vec(0, 0, 4)};
  const std::vector<double> radii(3, 1.0);
  const auto upright = fabric_tensor(column, radii, open_space, 0.01);
  CHECK(upright[2] == Approx(1.0));
  CHECK(upright[0] == 0.0);
}
