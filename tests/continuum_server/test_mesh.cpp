#include <catch2/catch.hpp>

#include "continuum_server/box_mesh.hpp"
#include "continuum_server/mesh.hpp"
#include "protocol/engine/engine.hpp"

using namespace gabion::continuum;
using gabion::engine::RequestError;
using gabion::engine::vec;

namespace {

std::string refusal(const Mesh& mesh) {
  try {
    check(mesh, 1);
  } catch (const RequestError& error) {
    return error.where + ": " + error.what();
  }
  return "accepted";
}

}  // namespace

TEST_CASE("a mesh that does not fit together is refused by field") {
  Mesh mesh = box_mesh({2, 1, 1}, vec(2, 1, 1));
  CHECK(refusal(mesh) == "accepted");
  SECTION("no elements") {
    mesh.elements.clear();
    CHECK(refusal(mesh) == "MESH.elements: the mesh has no element");
  }
  SECTION("node that does not exist") {
    mesh.elements[1][3] = 12;
    CHECK(refusal(mesh) == "MESH.elements: element 1 names number 12, but there are 12");
  }
  SECTION("material that does not exist") {
    mesh.material[1] = 1;
    CHECK(refusal(mesh) == "MESH.material: element 1 names number 1, but there are 1");
  }
  SECTION("node without element") {
    mesh.nodes.push_back(vec(5, 5, 5));
    CHECK(refusal(mesh) == "MESH.nodes: node 12 belongs to no element");
  }
  SECTION("position that is no number") {
    mesh.nodes[4][1] = std::nan("");
    CHECK(refusal(mesh) == "MESH.nodes: node 4 is not at a finite position");
  }
}

TEST_CASE("wrapped corners lie one period further along") {
  const Mesh mesh = box_mesh({1, 1, 2}, vec(1, 1, 2), {true, true, false});
  CHECK(mesh.nodes.size() == 3);
  const Corners corners = corners_of(mesh, 1, vec(1, 1, 0));
  CHECK(corners[6][0] == 1.0);
  CHECK(corners[6][1] == 1.0);
  CHECK(corners[6][2] == 2.0);
  Vec size;
  CHECK(is_brick(corners, size));
}

TEST_CASE("corner Jacobians see an inverted corner that the volume does not show") {
  Corners corners = corners_of(box_mesh({1, 1, 1}, vec(2, 2, 2)), 0, Vec{});
  CHECK(smallest_corner_jacobian(corners) == Approx(1.0).epsilon(1e-15));
  Vec size;
  CHECK(is_brick(corners, size));
  CHECK(size[0] == 2.0);
  corners[6] = vec(0.9, 0.9, 0.9);
  CHECK(smallest_corner_jacobian(corners) < 0.0);
  CHECK_FALSE(is_brick(corners, size));
}
