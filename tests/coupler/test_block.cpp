// Where the block begins: in touch with the grains, whatever of it points down.

#include <catch2/catch.hpp>
#include <cmath>
#include <random>

#include "coupler/ground/block.hpp"

using namespace gabion;
using namespace gabion::coupler;

namespace {

scene::Block cube(const std::string& tip) {
  scene::Block block;
  block.side = 2.0;
  block.mass = 1.0;
  block.tip = tip;
  return block;
}

constexpr double radius = 0.3;

GrainSet one_grain(double x, double y) {
  GrainSet grains;
  grains.position.push_back({x, y, 0.0});
  grains.radius.push_back(radius);
  return grains;
}

const scene::Box ground{{-2, -2, -2}, {2, 2, 0}};

}  // namespace

TEST_CASE("a grain below the middle is touched by what points down") {
  for (const char* tip : {"down", "edge", "face"})
    CHECK(place_block(cube(tip), ground, one_grain(0, 0)).lowest == Approx(radius).epsilon(1e-8));
}

TEST_CASE("a grain beside the tip is touched where the cube is") {
  // edge down along x: its faces rise by 45 degrees; a sphere at distance y is touched when the edge is y - sqrt(2) r below
  const double y = 0.7;
  CHECK(place_block(cube("edge"), ground, one_grain(0, y)).lowest == Approx(std::sqrt(2.0) * radius - y).epsilon(1e-7));
  // face down, grain outside the face but within a radius of its rim: the edge meets the sphere
  const double beyond = 0.2;
  CHECK(place_block(cube("face"), ground, one_grain(1.0 + beyond, 0)).lowest ==
        Approx(std::sqrt(radius * radius - beyond * beyond)).epsilon(1e-7));
}

TEST_CASE("no grain is cut, and one is touched") {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> place(-1.5, 1.5), size(0.05, 0.15);
  GrainSet grains;
  for (int k = 0; k < 400; ++k) {
    grains.position.push_back({place(random), place(random), 0.3 * place(random)});
    grains.radius.push_back(size(random));
  }
  const PlacedBlock placed = place_block(cube("down"), ground, grains);
  double smallest = scene::infinity;  // distance of a centre beyond the farthest face plane, less the radius: at least the true gap
  for (std::size_t g = 0; g < grains.position.size(); ++g) {
    double beyond = -scene::infinity;
    for (std::size_t f = 0; f + 1 < placed.face_ptr.size(); ++f) {
      const auto at = [&](int k) { return placed.vertices[static_cast<std::size_t>(placed.face_vertices[static_cast<std::size_t>(placed.face_ptr[f] + k)])]; };
      const Point a = at(0), b = at(1), c = at(2), &x = grains.position[g];
      const Point u{b[0] - a[0], b[1] - a[1], b[2] - a[2]}, v{c[0] - b[0], c[1] - b[1], c[2] - b[2]};
      const Point n{u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]};
      const double length = std::sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);
      beyond = std::max(beyond, (n[0] * (x[0] - a[0]) + n[1] * (x[1] - a[1]) + n[2] * (x[2] - a[2])) / length);
    }
    smallest = std::min(smallest, beyond - grains.radius[g]);
  }
  CHECK(smallest <= 1e-8);
  CHECK(smallest > -0.05);  // planes overestimate how near a sphere beside an edge is, never by more than its radius
  PlacedBlock lower = placed;
  CHECK(lower.lowest < 0.6);
}

TEST_CASE("a block beside the grains is refused") {
  CHECK_THROWS_WITH(place_block(cube("down"), ground, one_grain(5, 0)), Catch::Contains("no grain lies under the block"));
}

TEST_CASE("a sphere is a closed polyhedron of its volume") {
  scene::Block block = cube("down");
  block.shape = "sphere";
  const PlacedBlock placed = place_block(block, ground, one_grain(0.4, 0.3));
  REQUIRE(placed.face_ptr.size() == 321);
  double volume = 0.0;
  Point centre{};
  for (const Point& v : placed.vertices)
    for (int axis = 0; axis < 3; ++axis) centre[axis] += v[axis] / static_cast<double>(placed.vertices.size());
  for (std::size_t f = 0; f < 320; ++f) {
    const auto at = [&](int k) {
      Point x = placed.vertices[static_cast<std::size_t>(placed.face_vertices[3 * f + static_cast<std::size_t>(k)])];
      for (int axis = 0; axis < 3; ++axis) x[axis] -= centre[axis];
      return x;
    };
    const Point a = at(0), b = at(1), c = at(2);
    volume += (a[0] * (b[1] * c[2] - b[2] * c[1]) + a[1] * (b[2] * c[0] - b[0] * c[2]) + a[2] * (b[0] * c[1] - b[1] * c[0])) / 6.0;
  }
  CHECK(volume == Approx(4.0 / 3.0 * std::acos(-1.0)).epsilon(1e-9));
  // touches the grain: distance of the centres is the sum of the radii
  CHECK(std::hypot(0.4, 0.3, centre[2]) == Approx(1.0 + radius).epsilon(1e-8));
}
