#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <numbers>

#include "dem_server/packing/radii.hpp"
#include "protocol/engine/engine.hpp"

using namespace gabion::dem;
using gabion::engine::RequestError;

namespace {

double volume_of(const std::vector<double>& radii) {
  double total = 0.0;
  for (const double r : radii) total += 4.0 / 3.0 * std::numbers::pi * r * r * r;
  return total;
}

}  // namespace

TEST_CASE("uniform radii fill the volume exactly and are uniform by number") {
  Random random(7);
  const RadiusDistribution distribution("uniform", {0.05, 0.1});
  std::vector<double> radii = draw_radii(distribution, 4.0, random);
  CHECK(volume_of(radii) == Approx(4.0).epsilon(1e-12));
  CHECK(*std::min_element(radii.begin(), radii.end()) >= 0.05);
  CHECK(*std::max_element(radii.begin(), radii.end()) <= 0.1);
  // Kolmogorov's distance of a stratified sample is about one grain
  std::sort(radii.begin(), radii.end());
  double distance = 0.0;
  for (std::size_t k = 0; k < radii.size(); ++k)
    distance = std::max(distance, std::abs((radii[k] - 0.05) / 0.05 - (k + 0.5) / static_cast<double>(radii.size())));
  CHECK(distance < 5.0 / static_cast<double>(radii.size()));
}

TEST_CASE("closed forms of the means hold for both kinds") {
  for (const RadiusDistribution& distribution :
       {RadiusDistribution("uniform", {1.0, 2.0}), RadiusDistribution("sieve", {1.0, 0.0, 1.5, 0.3, 3.0, 1.0})}) {
    double fourth = 0.0, third = 0.0;
    constexpr int samples = 200000;
    for (int k = 0; k < samples; ++k) {
      const double r = distribution.quantile((k + 0.5) / samples);
      fourth += r * r * r * r / samples;
      third += r * r * r / samples;
    }
    CHECK(distribution.mean_radius_by_volume() == Approx(fourth / third).epsilon(1e-6));
    CHECK(distribution.mean_volume() == Approx(4.0 / 3.0 * std::numbers::pi * third).epsilon(1e-6));
  }
}

TEST_CASE("a sieve curve is met by mass") {
  Random random(3);
  const RadiusDistribution distribution("sieve", {0.02, 0.0, 0.03, 0.2, 0.05, 0.7, 0.06, 1.0});
  const std::vector<double> radii = draw_radii(distribution, 2.0, random);
  const double total = volume_of(radii);
  CHECK(total == Approx(2.0).epsilon(1e-12));
  for (const auto& [sieve, share] : {std::pair{0.03, 0.2}, {0.04, 0.45}, {0.05, 0.7}, {0.06, 1.0}}) {
    std::vector<double> passing;
    std::copy_if(radii.begin(), radii.end(), std::back_inserter(passing), [s = sieve](double r) { return r <= s; });
    CHECK(volume_of(passing) / total == Approx(share).margin(2e-3));
  }
}

TEST_CASE("equal radii fill the volume by a common scale") {
  Random random(1);
  const std::vector<double> radii = draw_radii(RadiusDistribution("uniform", {0.1, 0.1}), 1.0, random);
  CHECK(volume_of(radii) == Approx(1.0).epsilon(1e-12));
  for (const double r : radii) {
    CHECK(r == Approx(radii.front()).epsilon(1e-14));
    CHECK(r == Approx(0.1).epsilon(1e-3));
  }
}

TEST_CASE("radius distributions that make no sense are refused with the reason") {
  CHECK_THROWS_WITH(RadiusDistribution("normal", {1, 2}), Catch::Contains("unknown radius kind 'normal'"));
  CHECK_THROWS_AS(RadiusDistribution("uniform", {2, 1}), RequestError);
  CHECK_THROWS_AS(RadiusDistribution("uniform", {0, 1}), RequestError);
  CHECK_THROWS_AS(RadiusDistribution("uniform", {1}), RequestError);
  CHECK_THROWS_AS(RadiusDistribution("uniform", {1, NAN}), RequestError);
  CHECK_THROWS_WITH(RadiusDistribution("sieve", {1, 0, 2, 0.9}), Catch::Contains("0.9"));
  CHECK_THROWS_WITH(RadiusDistribution("sieve", {1, 0, 1, 0.5, 2, 1}), Catch::Contains("pair 1"));
  CHECK_THROWS_WITH(RadiusDistribution("sieve", {1, 0, 2, 0.5, 3, 0.4, 4, 1}), Catch::Contains("pair 2"));
}

TEST_CASE("the generator's words are those the standard prescribes") {
  // ISO C++ [rand.predef]: the 10 000th word of a default mt19937_64; pins uniform() to the same bits
  std::mt19937_64 reference;
  reference.discard(9999);
  REQUIRE(reference() == 9981545732273789042ull);
  Random random(std::mt19937_64::default_seed);
  for (int k = 0; k < 9999; ++k) random.uniform();
  CHECK(random.uniform() == static_cast<double>(9981545732273789042ull >> 11) * 0x1.0p-53);
}
