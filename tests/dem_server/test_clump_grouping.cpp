// Which spheres make a clump: sizes, compactness, leftovers, and that numbering has no say.

#include <algorithm>
#include <map>
#include <numeric>
#include <set>

#include "fixture.hpp"

using namespace gabion::dem;
using namespace gabion::dem::testing;

namespace {

struct Grouped {
  Grains grains;
  VecField x;
  Domain domain;
  ClumpGrouping clumps;
};

Grouped grouped(const Spheres& s, std::int32_t size, double gap, Domain domain = {},
                std::vector<std::int32_t> single = {}) {
  Grouped g;
  g.grains.radius = s.r;
  g.grains.material.assign(s.r.size(), 0);
  g.grains.materials = {elastic_material()};
  g.x = s.x;
  g.domain = domain;
  g.clumps = group_clumps(g.grains, g.x, domain, {{size}, gap, std::move(single)});
  return g;
}

/// Clump number of each grain.
std::vector<int> numbers(const Grouped& g) {
  std::vector<int> of(g.x.size(), -1);
  for (std::size_t b = 0; b < g.clumps.size(); ++b)
    for (std::int32_t k = g.clumps.start[b]; k < g.clumps.start[b + 1]; ++k)
      of[g.clumps.grain[k]] = static_cast<int>(b);
  return of;
}

}  // namespace

TEST_CASE("numbering does not change the clumps, in a periodic box as well") {
  const Spheres s = jittered(6, 5);
  for (const bool periodic : {false, true}) {
    Domain box{vec(-.5, -.5, -.5), vec(5.5, 5.5, 5.5), {periodic, periodic, periodic}};
    const Grouped plain = grouped(s, 4, 0.2, box);
    std::vector<std::size_t> order(s.x.size());
    std::iota(order.begin(), order.end(), 0);
    std::shuffle(order.begin(), order.end(), std::mt19937_64(7));
    Spheres shuffled;
    for (const std::size_t k : order) {
      shuffled.x.push_back(s.x[k]);
      shuffled.r.push_back(s.r[k]);
    }
    const Grouped again = grouped(shuffled, 4, 0.2, box);
    const std::vector<int> of = numbers(plain), of_again = numbers(again);
    for (std::size_t k = 0; k < order.size(); ++k) CHECK(of_again[k] == of[order[k]]);
    CHECK(plain.clumps.size() > 30);
    // a part of the grains that holds no contact to the rest gets the same clumps
    REQUIRE(plain.clumps.start == again.clumps.start);
    bool wraps = false;
    for (const auto& image : plain.clumps.image) wraps = wraps || image != std::array<std::int8_t, 3>{};
    CHECK(wraps == periodic);
  }
}

TEST_CASE("members touch one another, and sizes are about what was asked") {
  const Spheres s = jittered(7, 9);
  const double gap = 0.35;
  const Grouped g = grouped(s, 4, gap);
  std::map<std::size_t, int> sizes;
  for (std::size_t b = 0; b < g.clumps.size(); ++b) {
    const auto first = g.clumps.grain.begin() + g.clumps.start[b],
               last = g.clumps.grain.begin() + g.clumps.start[b + 1];
    ++sizes[static_cast<std::size_t>(last - first)];
    // connected: from the first member every one can be reached over touching pairs
    std::set<std::int32_t> reached{*first}, rest(first + 1, last);
    for (bool more = true; more;) {
      more = false;
      for (const std::int32_t j : rest)
        if (std::any_of(reached.begin(), reached.end(),
                        [&](std::int32_t i) { return norm(s.x[i] - s.x[j]) <= (1.0 + gap) * (s.r[i] + s.r[j]); })) {
          reached.insert(j);
          rest.erase(j);
          more = true;
          break;
        }
    }
    CHECK(rest.empty());
  }
  INFO(sizes[2] << " " << sizes[3] << " " << sizes[4] << " " << sizes[5] << " of " << g.clumps.size());
  CHECK(sizes[4] > 0.6 * static_cast<double>(g.clumps.size()));
  CHECK(sizes.begin()->first >= 2);
  CHECK(sizes.rbegin()->first <= 8);
}

TEST_CASE("shapes are compact, leftovers join the smallest neighbour, single grains stay so") {
  // a row of five: 0-1, 2-3, and 4 joins the clump that it touches
  const Spheres row{{vec(0, 0, 0), vec(1, 0, 0), vec(2, 0, 0), vec(3, 0, 0), vec(4, 0, 0)},
                    std::vector<double>(5, 0.5)};
  CHECK(numbers(grouped(row, 2, 0.0)) == std::vector<int>{0, 0, 1, 1, 1});
  CHECK(numbers(grouped(row, 2, 0.0, {}, {2})) == std::vector<int>{0, 0, -1, 1, 1});
  CHECK(numbers(grouped(row, 1, 0.0)) == std::vector<int>(5, -1));
  // a square beats a row: the fourth is nearest to the centre of three
  const Spheres square{{vec(0, 0, 0), vec(1, 0, 0), vec(2, 0, 0), vec(0, 1, 0), vec(1, 1, 0)},
                       std::vector<double>(5, 0.5)};
  CHECK(numbers(grouped(square, 4, 0.0)) == std::vector<int>{0, 0, 0, 0, 0});
  const Spheres wide{{vec(0, 0, 0), vec(1, 0, 0), vec(2, 0, 0), vec(3, 0, 0), vec(0, 1, 0), vec(1, 1, 0)},
                     std::vector<double>(6, 0.5)};
  CHECK(numbers(grouped(wide, 4, 0.0)) == std::vector<int>{0, 0, 1, 1, 0, 0});
}

TEST_CASE("a clump across a periodic side is whole, and its length shows in the aspect ratio") {
  const Spheres s{{vec(0.4, 2, 2), vec(3.4, 2, 2)}, {0.5, 0.5}};
  const Grouped g = grouped(s, 2, 0.01, {vec(0, 0, 0), vec(4, 4, 4), {true, true, true}});
  REQUIRE(g.clumps.size() == 1);
  const Clumped count = count_clumps(g.clumps, g.grains, g.x, g.domain);
  CHECK(count.grains == 2);
  CHECK(count.aspect_ratio == Approx(2.0));

  Scene scene;
  scene.periodic_box(vec(0, 0, 0), vec(4, 4, 4));
  scene.grains(s.x, s.r, elastic_material());
  scene.engine.make_clumps({{2}, 0.01, {}});
  scene.prepare(Geometry::updated);
  CHECK(scene.engine.contacts().size() == 0);
  scene.set("spin", VecField(2, vec(0, 0, 1)));
  scene.step(1e-3, 200);
  const auto& u = scene.engine.motion.displacement;
  CHECK(norm(s.x[0] + u[0] - s.x[1] - u[1] + vec(4, 0, 0)) == Approx(1.0).epsilon(1e-13));
  CHECK(u[0][1] == Approx(0.5 * std::sin(0.2)).epsilon(1e-6));
}
