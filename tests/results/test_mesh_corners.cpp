#include "coupler/results/mesh_corners.hpp"

#include <catch2/catch.hpp>

#include "coupler/results/errors.hpp"

using gabion::coupler::drawn_mesh;
using gabion::coupler::gather;
using gabion::coupler::ResultsError;

namespace {
// A row of two unit bricks along x that closes on itself: nodes at x = 0 and 1, period 2.
const std::vector<double> nodes = {0, 0, 0, 0, 1, 0, 0, 0, 1, 0, 1, 1, 1, 0, 0, 1, 1, 0, 1, 0, 1, 1, 1, 1};
const std::vector<std::int32_t> elements = {0, 4, 5, 1, 2, 6, 7, 3, 4, 0, 1, 5, 6, 2, 3, 7};
const std::vector<std::uint8_t> wrap = {0, 0, 0, 0, 0, 0, 0, 0, 0, 1, 1, 0, 0, 1, 1, 0};
}  // namespace

TEST_CASE("corners that wrap get a node of their own one period further") {
  const auto drawn = drawn_mesh(nodes, elements, wrap, {2.0, 0.0, 0.0});
  REQUIRE(drawn.source.size() == 12);
  for (std::size_t e = 0; e < 2; ++e) {
    double lowest = 1e9, highest = -1e9;
    for (std::size_t k = 0; k < 8; ++k) {
      const double x = drawn.nodes[3 * static_cast<std::size_t>(drawn.corners[8 * e + k])];
      lowest = std::min(lowest, x);
      highest = std::max(highest, x);
    }
    CHECK(lowest == static_cast<double>(e));
    CHECK(highest == static_cast<double>(e + 1));
  }
  for (std::size_t k = 0; k < 12; ++k) {
    const auto source = static_cast<std::size_t>(drawn.source[k]);
    CHECK(drawn.nodes[3 * k + 1] == nodes[3 * source + 1]);
    CHECK(drawn.nodes[3 * k + 2] == nodes[3 * source + 2]);
  }
}

TEST_CASE("nothing is repeated where nothing wraps") {
  const auto drawn = drawn_mesh(nodes, std::span(elements).first(8), {}, {});
  CHECK(drawn.nodes == nodes);
  CHECK(drawn.source.size() == 8);
}

TEST_CASE("values follow the drawn nodes") {
  CHECK(gather(std::vector<double>{1, 2, 3, 4}, 2, std::vector<std::int64_t>{1, 0, 1}) ==
        std::vector<double>{3, 4, 1, 2, 3, 4});
}

TEST_CASE("a mesh that does not fit together is refused") {
  CHECK_THROWS_AS(drawn_mesh(nodes, elements, std::vector<std::uint8_t>(3), {}), ResultsError);
  CHECK_THROWS_WITH(drawn_mesh(std::span(nodes).first(9), elements, {}, {}), Catch::Contains("names node 4 of 3"));
}
