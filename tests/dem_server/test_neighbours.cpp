#include <algorithm>
#include <catch2/catch.hpp>
#include <random>
#include <set>

#include "dem_server/neighbours.hpp"

using namespace gabion::dem;

namespace {

/// Every pair and every image, by brute force.
std::vector<Pair> all_pairs(const std::vector<Vec>& x, const std::vector<double>& r, double margin,
                            const Domain& domain, int most) {
  std::vector<Pair> pairs;
  int n[3];
  for (int axis = 0; axis < 3; ++axis) n[axis] = domain.periodic[axis] ? most : 0;
  for (int i = 0; i < static_cast<int>(x.size()); ++i)
    for (int j = i; j < static_cast<int>(x.size()); ++j)
      for (int a = -n[0]; a <= n[0]; ++a)
        for (int b = -n[1]; b <= n[1]; ++b)
          for (int c = -n[2]; c <= n[2]; ++c) {
            const std::array<std::int8_t, 3> image{static_cast<std::int8_t>(a), static_cast<std::int8_t>(b),
                                                   static_cast<std::int8_t>(c)};
            if (i == j && image <= std::array<std::int8_t, 3>{}) continue;
            if (norm(x[j] + domain.offset(image) - x[i]) <= r[i] + r[j] + margin) pairs.push_back({i, j, image});
          }
  std::sort(pairs.begin(), pairs.end());
  return pairs;
}

struct Cloud {
  std::vector<Vec> x;
  std::vector<double> r;
};

Cloud cloud(int n, double size, double smallest, double largest, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> place(-0.3 * size, 1.3 * size), exponent(0.0, 1.0);
  Cloud c;
  for (int k = 0; k < n; ++k) {
    c.x.push_back(vec(place(random), place(random), place(random)));
    c.r.push_back(smallest * std::pow(largest / smallest, exponent(random)));
  }
  return c;
}

}  // namespace

TEST_CASE("pairs agree with brute force in open and periodic boxes") {
  const bool flags[] = {false, true};
  for (const bool px : flags)
    for (const bool pz : flags) {
      const Cloud c = cloud(500, 1.0, 0.03, 0.07, 7);
      const Domain domain{vec(0, 0, 0), vec(1, 1, 1), {px, false, pz}};
      for (const double margin : {0.0, 0.03}) {
        const auto pairs = find_pairs(c.x, c.r, margin, domain);
        REQUIRE(pairs.size() > 100);
        CHECK(pairs == all_pairs(c.x, c.r, margin, domain, 3));
      }
    }
}

TEST_CASE("a size ratio of 20 loses no pair") {
  Cloud c = cloud(400, 1.0, 0.01, 0.2, 3);
  const Domain open{};
  CHECK(find_pairs(c.x, c.r, 0.002, open) == all_pairs(c.x, c.r, 0.002, open, 0));
  const Domain domain{vec(0, 0, 0), vec(1, 1, 1), {true, true, true}};
  CHECK(find_pairs(c.x, c.r, 0.002, domain) == all_pairs(c.x, c.r, 0.002, domain, 3));
}

TEST_CASE("boxes shorter than a diameter list every image once") {
  const Cloud c = cloud(12, 0.5, 0.1, 0.2, 11);
  for (const double width : {0.15, 0.3, 0.5, 0.8}) {
    const Domain domain{vec(0, 0, 0), vec(width, width, 1), {true, true, false}};
    const auto pairs = find_pairs(c.x, c.r, 0.01, domain);
    CHECK(pairs == all_pairs(c.x, c.r, 0.01, domain, 9));
    CHECK(std::set<Pair>(pairs.begin(), pairs.end()).size() == pairs.size());
  }
}

TEST_CASE("lattice columns of one and two cells keep their coordination of 12") {
  for (const int wide : {1, 2, 3}) {
    const double a = 1.0, r = a / std::sqrt(8.0);
    std::vector<Vec> x;
    const int high = 4;
    for (int i = 0; i < wide; ++i)
      for (int j = 0; j < wide; ++j)
        for (int k = 0; k < high; ++k)
          for (const Vec b : {vec(0, 0, 0), vec(.5, .5, 0), vec(.5, 0, .5), vec(0, .5, .5)})
            x.push_back(b + vec(i, j, k));
    const std::vector<double> radii(x.size(), r);
    const Domain domain{vec(0, 0, 0), vec(wide, wide, high), {true, true, true}};
    CHECK(find_pairs(x, radii, 1e-6, domain).size() == 6 * x.size());
  }
  // simple cubic, one sphere: it meets only itself, three times
  const std::vector<Vec> one{vec(0.2, 0.3, 0.4)};
  const std::vector<double> half{0.5};
  const Domain cube{vec(0, 0, 0), vec(1, 1, 1), {true, true, true}};
  const auto pairs = find_pairs(one, half, 1e-9, cube);
  REQUIRE(pairs.size() == 3);
  for (const Pair& p : pairs) CHECK((p.i == 0 && p.j == 0));
}

TEST_CASE("spheres far apart do not exhaust memory") {
  const std::vector<Vec> x{vec(0, 0, 0), vec(1e7, 1e7, -1e7), vec(0.15, 0, 0)};
  const std::vector<double> r{0.1, 0.1, 0.1};
  const auto pairs = find_pairs(x, r, 0.0, Domain{});
  REQUIRE(pairs.size() == 1);
  CHECK(pairs[0] == Pair{0, 2, {}});
}

TEST_CASE("the minimum image") {
  const Domain domain{vec(0, 0, 0), vec(2, 3, 4), {true, true, false}};
  const Vec d = domain.shift(vec(1.8, -2.0, 3.9));
  CHECK(d[0] == Approx(-0.2));
  CHECK(d[1] == Approx(1.0));
  CHECK(d[2] == Approx(3.9));
}

TEST_CASE("what cannot be searched is refused") {
  const std::vector<Vec> x{vec(0, 0, 0), vec(NAN, 0, 0)};
  const std::vector<double> r{1, 1};
  CHECK_THROWS_WITH(find_pairs(x, r, 0.0, Domain{}), Catch::Contains("grain 1") && Catch::Contains("not finite"));
  const std::vector<Vec> y{vec(0, 0, 0), vec(1, 0, 0)};
  CHECK_THROWS_WITH(find_pairs(y, r, -1.0, Domain{}), Catch::Contains("margin"));
  const std::vector<double> bad{1, -1};
  CHECK_THROWS_WITH(find_pairs(y, bad, 0.0, Domain{}), Catch::Contains("radius"));
}
