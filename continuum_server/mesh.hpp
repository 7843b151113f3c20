#pragma once
// The mesh as it comes in, and the geometry of its elements.

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "protocol/engine/vec.hpp"

namespace gabion::continuum {

using engine::Vec;
using engine::VecField;

/// Eight-node hexahedra. Corner order: (-,-,-) (+,-,-) (+,+,-) (-,+,-), then the same at +z. A corner whose
/// wrap bit b (x = 1, y = 2, z = 4) is set lies one period further along axis b than its node.
struct Mesh {
  VecField nodes;                                     ///< m
  std::vector<std::array<std::int32_t, 8>> elements;  ///< nodes of each element
  std::vector<std::array<std::uint8_t, 8>> wrap;      ///< empty: nothing wraps
  std::vector<std::int32_t> material;                 ///< index into the materials
};

/// Positions of an element's corners, m, in the mesh's order.
using Corners = std::array<Vec, 8>;

/// engine::RequestError naming MESH and the field: sizes that do not fit, an index that does not exist, a
/// position that is not finite, a node without element.
void check(const Mesh& mesh, std::size_t material_count);

/// period: lengths of the ground's box, m. With displacements, where the corners are now.
Corners corners_of(const Mesh& mesh, std::size_t element, Vec period, const VecField* displacement = nullptr);

/// Determinant of d(x)/d(xi) at a corner, m3; the element is inverted where it is not positive.
double corner_jacobian(const Corners& corners, int corner);

/// Smallest of the eight.
double smallest_corner_jacobian(const Corners& corners);

Vec centre_of(const Corners& corners);

/// Whether the element is a rectangular box along the axes; then size gets its edges, m.
bool is_brick(const Corners& corners, Vec& size);

}  // namespace gabion::continuum
