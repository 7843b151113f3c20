#include "coupler/ground/loose_grains.hpp"

#include <algorithm>
#include <catch2/catch.hpp>
#include <random>

using namespace gabion;

namespace {

coupler::Packing scattered(std::size_t count, double side, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> unit(0.0, 1.0);
  coupler::Packing packing;
  packing.gap = 0.05;
  for (std::size_t g = 0; g < count; ++g) {
    packing.position.push_back({side * unit(random), side * unit(random), side * unit(random)});
    packing.radius.push_back(0.3 + 0.3 * unit(random));
  }
  return packing;
}

}  // namespace

TEST_CASE("contact pairs are those of the definition, periodic directions included") {
  const double side = 7.0;
  const coupler::Packing packing = scattered(300, side, 5);
  for (const bool periodic : {false, true}) {
    scene::Ground ground{.box = {{0, 0, 0}, {side, side, side}}, .material = "", .periodic = {periodic, false, periodic}};
    std::vector<std::array<std::int32_t, 2>> expected;
    for (std::int32_t i = 0; i < 300; ++i)
      for (std::int32_t j = i + 1; j < 300; ++j) {
        double square = 0.0;
        for (int axis = 0; axis < 3; ++axis) {
          double d = packing.position[j][axis] - packing.position[i][axis];
          if (ground.periodic[axis]) d -= side * std::round(d / side);
          square += d * d;
        }
        if (std::sqrt(square) <= 1.05 * (packing.radius[i] + packing.radius[j])) expected.push_back({i, j});
      }
    auto found = coupler::contact_pairs(packing, ground);
    std::sort(found.begin(), found.end());
    CHECK(found == expected);
  }
}

TEST_CASE("a cut takes what it leaves hanging, and what then hangs, but nothing that was loose before or is held") {
  // a chain 0-1-2-3 below a removed grain 4; 5 was alone from the start
  const std::vector<std::array<std::int32_t, 2>> pairs{{0, 1}, {1, 2}, {2, 3}, {3, 4}};
  std::vector<char> kept{1, 1, 1, 1, 0, 1}, held(6, 0);
  held[0] = 1;
  CHECK(coupler::drop_loose_grains(pairs, held, 2, kept) == 3);
  CHECK(kept == std::vector<char>{1, 0, 0, 0, 0, 1});

  kept = {1, 1, 1, 1, 0, 1};
  held[3] = 1;
  CHECK(coupler::drop_loose_grains(pairs, held, 2, kept) == 0);
}
