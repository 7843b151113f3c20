#include "coupler/ground/grid.hpp"

#include <algorithm>
#include <cmath>

namespace gabion::coupler {

std::int64_t Grid::node(int i, int j, int k) const {
  const auto wrapped = [&](int line, int axis) { return periodic_[axis] ? line % nodes(axis) : line; };
  return wrapped(i, 0) + std::int64_t{nodes(0)} * (wrapped(j, 1) + std::int64_t{nodes(1)} * wrapped(k, 2));
}

Point Grid::node_position(std::int64_t node) const {
  const std::int64_t nx = nodes(0), ny = nodes(1);
  return {lines_[0][static_cast<std::size_t>(node % nx)], lines_[1][static_cast<std::size_t>(node / nx % ny)],
          lines_[2][static_cast<std::size_t>(node / (nx * ny))]};
}

Point Grid::cell_centre(const Cell& cell) const {
  Point centre;
  for (int axis = 0; axis < 3; ++axis) {
    const std::size_t line = static_cast<std::size_t>(cell[axis]);
    centre[axis] = 0.5 * (lines_[axis][line] + lines_[axis][line + 1]);
  }
  return centre;
}

double Grid::cell_volume(const Cell& cell) const {
  double volume = 1.0;
  for (int axis = 0; axis < 3; ++axis) {
    const std::size_t line = static_cast<std::size_t>(cell[axis]);
    volume *= lines_[axis][line + 1] - lines_[axis][line];
  }
  return volume;
}

Cell Grid::locate(const Point& x) const {
  Cell cell;
  for (int axis = 0; axis < 3; ++axis) {
    const auto& lines = lines_[axis];
    const auto above = std::upper_bound(lines.begin(), lines.end(), x[axis]);
    cell[axis] = std::clamp(static_cast<int>(above - lines.begin()) - 1, 0, cells(axis) - 1);
  }
  return cell;
}

Stencil Grid::stencil(const Cell& cell, const Point& x) const {
  std::array<std::array<double, 2>, 3> hat;
  for (int axis = 0; axis < 3; ++axis) {
    const std::size_t line = static_cast<std::size_t>(cell[axis]);
    const double upper = (x[axis] - lines_[axis][line]) / (lines_[axis][line + 1] - lines_[axis][line]);
    hat[axis] = {1.0 - upper, upper};
  }
  Stencil stencil;
  for (int corner = 0; corner < 8; ++corner) {
    const int a = corner & 1, b = corner >> 1 & 1, c = corner >> 2;
    stencil.node[corner] = node(cell[0] + a, cell[1] + b, cell[2] + c);
    stencil.value[corner] = hat[0][a] * hat[1][b] * hat[2][c];
  }
  return stencil;
}

Grid Grid::coarsened(const std::array<std::vector<double>, 3>& kept) const {
  std::array<std::vector<double>, 3> lines;
  for (int axis = 0; axis < 3; ++axis) {
    const auto& fine = lines_[axis];
    const double spacing = fine[1] - fine[0];
    const auto must_stay = [&](double line) {
      return std::any_of(kept[axis].begin(), kept[axis].end(),
                         [&](double k) { return std::fabs(k - line) < 1e-6 * spacing; });
    };
    bool previous_kept = false;
    for (std::size_t i = 0; i < fine.size(); ++i) {
      const bool end = i == 0 || i + 1 == fine.size() || must_stay(fine[i]);
      const bool keep = end || !previous_kept;
      if (keep) lines[axis].push_back(fine[i]);
      previous_kept = keep;
    }
  }
  return Grid(std::move(lines), periodic_);
}

}  // namespace gabion::coupler
