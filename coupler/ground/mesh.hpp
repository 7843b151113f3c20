#pragma once
// The hexahedral mesh around the grains: a rectilinear grid fitted to ground and zone, with a hole.

#include <cstdint>
#include <optional>
#include <vector>

#include "coupler/ground/grid.hpp"
#include "coupler/ground/zone.hpp"

namespace gabion::coupler {

struct HexMesh {
  Grid grid;
  std::vector<Point> nodes;                           ///< m; interface nodes first, then by the levels of their elements
  std::vector<std::array<std::int32_t, 8>> elements;  ///< corner order as in PROTOCOL.md, MESH
  std::vector<std::array<std::uint8_t, 8>> wrap;      ///< bits x = 1, y = 2, z = 4
  std::vector<Cell> cells;                            ///< grid cell of each element
  std::vector<std::int32_t> node_of_grid;             ///< mesh node of a grid node, -1 where none
  std::vector<std::int32_t> element_of_cell;          ///< -1 in the hole
  std::vector<std::uint8_t> level;                    ///< of each element, see rate_levels; empty: one rate

  std::int32_t element_at(const Cell& cell) const;
  /// Mesh element and its stencil, mesh nodes, at x. Inside the hole: the element beyond the nearest
  /// outer face, shape functions extrapolated.
  Stencil stencil(const Zone& zone, const Point& x) const;
  /// The same, with the shape functions evaluated at `at` instead of x.
  Stencil stencil(const Zone& zone, const Point& x, const Point& at) const;
};

/// Grid lines: every break of ground, outer and inner box is a line; between, the size is fitted.
/// Away from the zone the size grows by `grading` a layer.
Grid make_grid(const scene::Scene& scene, const Zone& zone);

/// Elements of the grid but those in the hole (zone.inner()); no hole without interface. rates: as the scene wants them;
/// nodes are then numbered by the smallest, then by the largest level of their elements.
HexMesh make_mesh(const Grid& grid, const Zone& zone, const std::optional<scene::Rates>& rates = {});

}  // namespace gabion::coupler
