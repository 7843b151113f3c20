#include "continuum_server/mesh.hpp"

#include <algorithm>
#include <cmath>
#include <string>

#include "continuum_server/hadamard.hpp"
#include "protocol/engine/engine.hpp"

namespace gabion::continuum {

namespace {

using engine::RequestError;

// An element this close to a box (of its smallest edge) is one: the error is then of the same order.
constexpr double brick_tolerance = 1e-10;

constexpr int corner_of_bits(int bits) {
  return corner_at[bits];
}  // the order is its own inverse

void check_index(const char* field, std::size_t element, std::int32_t index, std::size_t count) {
  if (index < 0 || static_cast<std::size_t>(index) >= count)
    throw RequestError(std::string("MESH.") + field,
                       "element " + std::to_string(element) + " names number " + std::to_string(index) +
                           ", but there are " + std::to_string(count),
                       "number from 0");
}

}  // namespace

void check(const Mesh& mesh, std::size_t material_count) {
  const std::size_t count = mesh.elements.size();
  if (count == 0) throw RequestError("MESH.elements", "the mesh has no element", "send MESH with at least one");
  if (mesh.material.size() != count || (!mesh.wrap.empty() && mesh.wrap.size() != count))
    throw RequestError("MESH.material",
                       std::to_string(count) + " elements, but " + std::to_string(mesh.material.size()) +
                           " materials and " + std::to_string(mesh.wrap.size()) + " rows of wrap",
                       "send one of each per element");
  for (std::size_t n = 0; n < mesh.nodes.size(); ++n)
    if (!std::isfinite(engine::sum(mesh.nodes[n])))
      throw RequestError("MESH.nodes", "node " + std::to_string(n) + " is not at a finite position",
                         "check the coordinates");
  std::vector<bool> used(mesh.nodes.size(), false);
  for (std::size_t e = 0; e < count; ++e) {
    check_index("material", e, mesh.material[e], material_count);
    for (const std::int32_t n : mesh.elements[e]) {
      check_index("elements", e, n, mesh.nodes.size());
      used[n] = true;
    }
  }
  const auto orphan = std::find(used.begin(), used.end(), false);
  if (orphan != used.end())
    throw RequestError("MESH.nodes", "node " + std::to_string(orphan - used.begin()) + " belongs to no element",
                       "leave out nodes that no element uses");
}

Corners corners_of(const Mesh& mesh, std::size_t element, Vec period, const VecField* displacement) {
  Corners corners;
  for (int c = 0; c < 8; ++c) {
    const std::int32_t node = mesh.elements[element][c];
    corners[c] = mesh.nodes[node];
    if (displacement) corners[c] += (*displacement)[node];
    if (mesh.wrap.empty()) continue;
    for (int axis = 0; axis < 3; ++axis)
      if (mesh.wrap[element][c] >> axis & 1) corners[c][axis] += period[axis];
  }
  return corners;
}

double corner_jacobian(const Corners& corners, int corner) {
  // the columns of the Jacobian are half the three edges that meet at the corner
  const int bits = corner_at[corner];
  Vec edge[3];
  for (int axis = 0; axis < 3; ++axis) {
    const int bit = 1 << axis;
    edge[axis] = corners[corner_of_bits(bits | bit)] - corners[corner_of_bits(bits & ~bit)];
  }
  return 0.125 * engine::dot(edge[0], engine::cross(edge[1], edge[2]));
}

double smallest_corner_jacobian(const Corners& corners) {
  double smallest = INFINITY;
  for (int c = 0; c < 8; ++c) {
    const double here = corner_jacobian(corners, c);
    if (!(here >= smallest)) smallest = here;  // keeps NaN
    if (std::isnan(here)) break;
  }
  return smallest;
}

Vec centre_of(const Corners& corners) {
  Vec total{};
  for (const Vec& corner : corners) total += corner;
  return engine::splat(0.125) * total;
}

bool is_brick(const Corners& corners, Vec& size) {
  const Vec low = corners[0];
  size = corners[6] - low;
  const double smallest = std::min({size[0], size[1], size[2]});
  if (!(smallest > 0.0)) return false;
  for (int c = 0; c < 8; ++c)
    for (int axis = 0; axis < 3; ++axis) {
      const double expected = corner_sign(c, axis) > 0 ? size[axis] : 0.0;
      if (!(std::fabs(corners[c][axis] - low[axis] - expected) <= brick_tolerance * smallest)) return false;
    }
  return true;
}

}  // namespace gabion::continuum
