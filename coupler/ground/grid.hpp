#pragma once
// Rectilinear grids and their trilinear shape functions.

#include <array>
#include <cstdint>
#include <vector>

#include "coupler/scene/scene.hpp"

namespace gabion::coupler {

using scene::Box;
using scene::Point;

/// Up to eight grid nodes with the value of their shape function at a point; sums to 1.
struct Stencil {
  std::array<std::int64_t, 8> node;  ///< grid node indices, see Grid::node
  std::array<double, 8> value;
};

/// Cell of a grid, by index in x, y, z.
using Cell = std::array<int, 3>;

/// Grid lines in x, y, z. In a periodic direction the last line is the first one again.
class Grid {
 public:
  Grid() = default;
  Grid(std::array<std::vector<double>, 3> lines, std::array<bool, 3> periodic)
      : lines_(std::move(lines)), periodic_(periodic) {}

  int cells(int axis) const { return static_cast<int>(lines_[axis].size()) - 1; }
  int nodes(int axis) const { return cells(axis) + (periodic_[axis] ? 0 : 1); }
  std::int64_t node_count() const { return std::int64_t{nodes(0)} * nodes(1) * nodes(2); }
  const std::vector<double>& lines(int axis) const { return lines_[axis]; }
  bool periodic(int axis) const { return periodic_[axis]; }

  /// Index of the node on lines i, j, k; wraps in periodic directions.
  std::int64_t node(int i, int j, int k) const;
  Point node_position(std::int64_t node) const;

  Point cell_centre(const Cell& cell) const;
  double cell_volume(const Cell& cell) const;

  /// The cell that holds x; outside the grid the nearest one. Points on a line belong to the cell above,
  /// at the upper end to the last one.
  Cell locate(const Point& x) const;

  /// Shape functions of the cell's eight nodes at x, extrapolated when x lies outside the cell.
  Stencil stencil(const Cell& cell, const Point& x) const;

  /// The grid with every second line left out, keeping the lines at the given positions.
  Grid coarsened(const std::array<std::vector<double>, 3>& kept) const;

 private:
  std::array<std::vector<double>, 3> lines_;
  std::array<bool, 3> periodic_{};
};

}  // namespace gabion::coupler
