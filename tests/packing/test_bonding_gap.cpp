#include <catch2/catch.hpp>

#include "dem_server/packing/bonding_gap.hpp"
#include "tests/packing/lattices.hpp"

using namespace gabion::dem;

TEST_CASE("a lattice bonds its nearest, then its second neighbours") {
  lattice::Lattice cubic = lattice::simple_cubic(5, true);
  const BondingGap near = find_bonding_gap(cubic.centres, cubic.radii, cubic.box, 6.0, 3);
  CHECK(near.contacts_per_grain == 6.0);
  CHECK(near.gap < std::sqrt(2.0) - 1.0);
  const BondingGap second = find_bonding_gap(cubic.centres, cubic.radii, cubic.box, 18.0, 3);
  CHECK(second.contacts_per_grain == 18.0);
  CHECK(second.gap >= std::sqrt(2.0) - 1.0);
}

TEST_CASE("grains with too few contacts go one after the other") {
  // A chain hangs on a lattice: its end has one contact; each removal strips the next one
  lattice::Lattice cubic = lattice::simple_cubic(4, false);
  const std::size_t core = cubic.centres.size();
  for (int k = 1; k <= 5; ++k) cubic.centres.push_back(vec(7.0 + 2.0 * k, 1.0, 1.0));
  cubic.radii.assign(cubic.centres.size(), 1.0);
  cubic.box.hi = vec(18.0, 8.0, 8.0);
  const BondingGap bonding = find_bonding_gap(cubic.centres, cubic.radii, cubic.box, 4.0, 3);
  for (std::size_t g = 0; g < cubic.centres.size(); ++g) CHECK(static_cast<bool>(bonding.kept[g]) == (g < core));
}

TEST_CASE("a part that hangs together with nothing is removed") {
  lattice::Lattice cubic = lattice::simple_cubic(4, false);
  const std::size_t core = cubic.centres.size();
  for (int k = 0; k < 8; ++k)
    cubic.centres.push_back(vec(20.0 + 2.0 * (k & 1), 2.0 + 2.0 * (k >> 1 & 1), 2.0 + 2.0 * (k >> 2)));
  cubic.radii.assign(cubic.centres.size(), 1.0);
  cubic.box.hi = vec(30.0, 8.0, 8.0);
  const BondingGap bonding = find_bonding_gap(cubic.centres, cubic.radii, cubic.box, 4.5, 3);
  for (std::size_t g = 0; g < cubic.centres.size(); ++g) CHECK(static_cast<bool>(bonding.kept[g]) == (g < core));
}

TEST_CASE("overlapping grains stay bonded: the gap is never negative") {
  lattice::Lattice cubic = lattice::simple_cubic(5, true);
  cubic.radii.assign(cubic.radii.size(), 1.01);
  const BondingGap bonding = find_bonding_gap(cubic.centres, cubic.radii, cubic.box, 4.0, 3);
  CHECK(bonding.gap == 0.0);
  CHECK(bonding.contacts_per_grain == 6.0);
}
