#include <catch2/catch.hpp>
#include <cmath>

#include "tests/coupler/sample.hpp"

using namespace sample;

namespace {

/// An affine displacement, one component.
double affine(const Point& x) { return 0.3 + 0.7 * x[0] - 0.2 * x[1] + 1.1 * x[2]; }

double row_sum(const coupler::SparseRows& rows, std::size_t r, const std::vector<Point>& points) {
  double sum = 0.0;
  for (std::int32_t k = rows.row_ptr[r]; k < rows.row_ptr[r + 1]; ++k) sum += rows.values[k] * affine(points[rows.columns[k]]);
  return sum;
}

struct Case {
  const char* scheme;
  bool edge;
};

}  // namespace

TEST_CASE("gap rows are silent for affine fields", "[rows]") {
  const auto [scheme, edge] = GENERATE(Case{"mortar", false}, Case{"mortar2h", false}, Case{"edge_hats", true});
  const scene::Box zone = GENERATE(half, pit);
  const Ground g = Ground::make(zone, 6.0 / 2, 1.5, edge);
  const auto rows = g.rows(scheme, 1.25);
  REQUIRE(rows.kind == coupler::InterfaceRows::Kind::gap);
  REQUIRE(rows.slots > 0);
  for (std::size_t r = 0; r < rows.slots; ++r)
    REQUIRE(std::fabs(row_sum(rows.grains, r, g.grains.position) + row_sum(rows.nodes, r, g.mesh.nodes)) < 1e-11);
}

TEST_CASE("gap rows are scaled so that a multiplier is an impulse", "[rows]") {
  const Ground g = Ground::make(half, 3.0, 1.5, false);
  const auto rows = g.rows("mortar");
  for (std::size_t r = 0; r < rows.slots; ++r) {
    double grains = 0.0, nodes = 0.0;
    for (std::int32_t k = rows.grains.row_ptr[r]; k < rows.grains.row_ptr[r + 1]; ++k) grains += rows.grains.values[k];
    for (std::int32_t k = rows.nodes.row_ptr[r]; k < rows.nodes.row_ptr[r + 1]; ++k) nodes += rows.nodes.values[k];
    REQUIRE(grains == Approx(-1.0).margin(1e-12));
    REQUIRE(nodes == Approx(1.0).margin(1e-12));
  }
}

TEST_CASE("slave rows reproduce affine fields", "[rows]") {
  const auto [scheme, edge] = GENERATE(Case{"strict", false}, Case{"edge", true});
  const scene::Box zone = GENERATE(half, pit);
  const Ground g = Ground::make(zone, 3.0, 1.5, edge);
  const auto rows = g.rows(scheme);
  REQUIRE(rows.tied_grains.size() > 0);
  std::vector<Point> slots;
  for (const std::int32_t n : rows.tied_nodes) slots.push_back(g.mesh.nodes[n]);
  for (std::size_t t = 0; t < rows.tied_grains.size(); ++t)
    REQUIRE(row_sum(rows.grains, t, slots) == Approx(affine(g.grains.position[rows.tied_grains[t]])).margin(1e-11));
}

TEST_CASE("edge ties grains on both sides of the border and no others", "[rows]") {
  const Ground g = Ground::make(half, 0.0, 1.5, true);
  const auto rows = g.rows("edge", 0.9);
  std::size_t below = 0, above = 0;
  for (const std::int32_t i : rows.tied_grains) {
    const double t = g.grains.position[i][2] - 15.0;
    REQUIRE(std::fabs(t) <= 0.9 * g.grains.radius[i] * (1 + 1e-9));
    (t < 0 ? below : above) += 1;
  }
  REQUIRE(below > 0);
  REQUIRE(above > 0);
}

TEST_CASE("projected edge rows use the four nodes of the border face", "[rows]") {
  const Ground g = Ground::make(half, 0.0, 1.5, true);
  const auto rows = g.rows("edge_projected", 1.0);
  for (const std::int32_t n : rows.tied_nodes) REQUIRE(g.mesh.nodes[n][2] == Approx(15.0));
}

TEST_CASE("rows say what to do when nothing can be tied", "[rows]") {
  const Ground g = Ground::make(half, 0.0, 1.5, true);
  CHECK_THROWS_WITH(g.rows("edge", 1e-6), Catch::Contains("coupling.reach"));
}

TEST_CASE("multiplier nodes with few grains join a neighbour", "[rows]") {
  const Ground fine = Ground::make(half, 3.0, 0.75, false);
  const auto rows = fine.rows("mortar");
  CHECK(rows.merged_rows > 0);
  const Ground coarse = Ground::make(half, 6.0, 3.0, false);
  CHECK(coarse.rows("mortar").merged_rows == 0);
}

TEST_CASE("the share of grains in the overlap is one half on an end plane", "[zone]") {
  const coupler::Zone zone({{0, 0, 0}, {12, 12, 24}}, half, 3.0, 0.01);
  CHECK(zone.overlap_share({6, 6, 15}, 0.5) == Approx(0.5));
  CHECK(zone.overlap_share({6, 6, 12}, 0.5) == Approx(0.5));
  CHECK(zone.overlap_share({6, 6, 13.5}, 0.5) == Approx(1.0));
  CHECK(zone.overlap_share({6, 6, 11}, 0.5) == 0.0);
  CHECK(zone.weight({6, 6, 13.5}) == Approx(0.5));
  CHECK(zone.weight({6, 6, 14.999}) == Approx(0.01));
  CHECK(zone.weight({6, 6, 2}) == 1.0);
}
