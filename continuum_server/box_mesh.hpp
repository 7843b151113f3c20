#pragma once
// Meshes of a box, for benchmarks and tests.

#include <algorithm>
#include <array>
#include <cstdint>
#include <numeric>
#include <utility>

#include "continuum_server/mesh.hpp"

namespace gabion::continuum {

/// count elements along each axis in a box from the origin, edges in m; x fastest. Where periodic, the last layer
/// of nodes is the first one, wrapped.
inline Mesh box_mesh(std::array<int, 3> count, Vec edges, std::array<bool, 3> periodic = {}) {
  Mesh mesh;
  int nodes[3];
  for (int axis = 0; axis < 3; ++axis) nodes[axis] = count[axis] + (periodic[axis] ? 0 : 1);
  for (int z = 0; z < nodes[2]; ++z)
    for (int y = 0; y < nodes[1]; ++y)
      for (int x = 0; x < nodes[0]; ++x)
        mesh.nodes.push_back(engine::vec(edges[0] * x / count[0], edges[1] * y / count[1], edges[2] * z / count[2]));
  constexpr int corner[8][3] = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}, {0, 0, 1}, {1, 0, 1}, {1, 1, 1}, {0, 1, 1}};
  for (int z = 0; z < count[2]; ++z)
    for (int y = 0; y < count[1]; ++y)
      for (int x = 0; x < count[0]; ++x) {
        auto& element = mesh.elements.emplace_back();
        auto& wrap = mesh.wrap.emplace_back();
        for (int c = 0; c < 8; ++c) {
          int at[3] = {x + corner[c][0], y + corner[c][1], z + corner[c][2]};
          wrap[c] = 0;
          for (int axis = 0; axis < 3; ++axis)
            if (at[axis] == nodes[axis]) {
              at[axis] = 0;
              wrap[c] = static_cast<std::uint8_t>(wrap[c] | 1 << axis);
            }
          element[c] = at[0] + nodes[0] * (at[1] + nodes[1] * at[2]);
        }
      }
  mesh.material.assign(mesh.elements.size(), 0);
  return mesh;
}

/// Numbers the nodes by the smallest, then by the largest rate of their elements, else as before.
inline void number_by_rates(Mesh& mesh, const std::vector<std::uint8_t>& rate) {
  std::vector<std::pair<int, int>> key(mesh.nodes.size(), {256, 0});
  for (std::size_t e = 0; e < mesh.elements.size(); ++e)
    for (const std::int32_t n : mesh.elements[e])
      key[n] = {std::min<int>(key[n].first, rate[e]), std::max<int>(key[n].second, rate[e])};
  std::vector<std::int32_t> order(mesh.nodes.size()), place(mesh.nodes.size());
  std::iota(order.begin(), order.end(), 0);
  std::stable_sort(order.begin(), order.end(), [&](std::int32_t a, std::int32_t b) { return key[a] < key[b]; });
  const VecField nodes = mesh.nodes;
  for (std::size_t k = 0; k < order.size(); ++k) {
    mesh.nodes[k] = nodes[order[k]];
    place[order[k]] = static_cast<std::int32_t>(k);
  }
  for (auto& element : mesh.elements)
    for (std::int32_t& n : element) n = place[n];
}

/// Moves every node by up to amount (m) along each axis, always the same way.
inline void distort(Mesh& mesh, double amount) {
  std::uint32_t state = 12345;
  for (Vec& node : mesh.nodes)
    for (int axis = 0; axis < 3; ++axis) {
      state = state * 1664525u + 1013904223u;  // Numerical Recipes' quick generator
      node[axis] += amount * (2.0 * (state >> 8) / double(1 << 24) - 1.0);
    }
}

}  // namespace gabion::continuum
