#include "coupler/ground/mesh.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "coupler/ground/layers.hpp"

namespace gabion::coupler {

namespace {

/// Lines from a to b, size h at the end `fine_at_a` names, growing by `grading` a layer; fitted to the length.
std::vector<double> graded_lines(double a, double b, double h, double grading, bool fine_at_a) {
  std::vector<double> sizes;
  double length = 0.0, size = h;
  while (length + 0.5 * size < b - a) {
    sizes.push_back(size);
    length += size;
    size *= grading;
  }
  if (sizes.empty()) sizes.push_back(length = b - a);
  if (!fine_at_a) std::reverse(sizes.begin(), sizes.end());
  std::vector<double> lines{a};
  double sum = 0.0;
  for (std::size_t i = 0; i + 1 < sizes.size(); ++i) lines.push_back(a + (sum += sizes[i]) * (b - a) / length);
  lines.push_back(b);
  return lines;
}

void append(std::vector<double>& lines, const std::vector<double>& more) {
  lines.insert(lines.end(), more.begin() + (lines.empty() ? 0 : 1), more.end());
}

/// What nodes are sorted by: the interface's first, then by the smallest and the largest level of their elements.
std::vector<int> sorting_keys(const std::vector<std::uint8_t>& rank, const std::vector<std::uint8_t>& level,
                              const std::vector<std::array<std::int64_t, 8>>& corners) {
  constexpr int levels = 256;
  std::vector<int> lowest(rank.size(), level.empty() ? 0 : levels), highest(rank.size(), 0), key(rank.size());
  for (std::size_t e = 0; e < level.size(); ++e)
    for (const std::int64_t n : corners[e]) {
      lowest[n] = std::min<int>(lowest[n], level[e]);
      highest[n] = std::max<int>(highest[n], level[e]);
    }
  for (std::size_t n = 0; n < rank.size(); ++n) key[n] = rank[n] == 0 ? 0 : 1 + levels * lowest[n] + highest[n];
  return key;
}

}  // namespace

Grid make_grid(const scene::Scene& scene, const Zone& zone) {
  std::array<std::vector<double>, 3> lines;
  const Box& ground = scene.ground.box;
  for (int axis = 0; axis < 3; ++axis) {
    std::vector<double> breaks{ground.lo[axis], ground.hi[axis]};
    for (const Box* box : {&zone.outer(), &zone.inner()})
      for (const double p : {box->lo[axis], box->hi[axis]})
        if (std::isfinite(p)) breaks.push_back(p);
    std::sort(breaks.begin(), breaks.end());
    const double tiny = 1e-9 * (ground.hi[axis] - ground.lo[axis]);
    breaks.erase(std::unique(breaks.begin(), breaks.end(), [&](double a, double b) { return b - a < tiny; }),
                 breaks.end());
    for (std::size_t i = 0; i + 1 < breaks.size(); ++i) {
      const bool below = std::isfinite(zone.outer().lo[axis]) && breaks[i + 1] <= zone.outer().lo[axis] + tiny;
      const bool above = std::isfinite(zone.outer().hi[axis]) && breaks[i] >= zone.outer().hi[axis] - tiny;
      const double grading = below || above ? scene.mesh.grading : 1.0;
      append(lines[axis], graded_lines(breaks[i], breaks[i + 1], scene.mesh.size, grading, !below));
    }
  }
  return Grid(std::move(lines), scene.ground.periodic);
}

HexMesh make_mesh(const Grid& grid, const Zone& zone, const std::optional<scene::Rates>& rates) {
  HexMesh mesh;
  mesh.grid = grid;
  const int nx = grid.cells(0), ny = grid.cells(1), nz = grid.cells(2);
  mesh.element_of_cell.assign(static_cast<std::size_t>(nx) * ny * nz, -1);
  std::vector<std::uint8_t> rank(static_cast<std::size_t>(grid.node_count()), 2);  // 0 interface, 1 other, 2 unused
  const bool hole = zone.has_interface();

  const auto corner_line = [](int corner, int axis) {  // 0 or 1; corners run round the bottom, then round the top
    constexpr int bits[8][3] = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}, {0, 0, 1}, {1, 0, 1}, {1, 1, 1}, {0, 1, 1}};
    return bits[corner][axis];
  };
  std::vector<std::array<std::int64_t, 8>> corners;
  std::vector<bool> interface_elements;
  for (int k = 0; k < nz; ++k)
    for (int j = 0; j < ny; ++j)
      for (int i = 0; i < nx; ++i) {
        const Cell cell{i, j, k};
        const Point centre = grid.cell_centre(cell);
        if (hole && zone.beyond_inner(centre) < 0.0) continue;
        // edge: elements at the border are interface; bridging: elements inside the outer box
        const double margin = std::cbrt(grid.cell_volume(cell));
        const bool interface_element = hole && zone.beyond_outer(centre) < (zone.overlap() > 0.0 ? 0.0 : margin);
        mesh.element_of_cell[static_cast<std::size_t>(i) + static_cast<std::size_t>(nx) * (j + static_cast<std::size_t>(ny) * k)] =
            static_cast<std::int32_t>(mesh.cells.size());
        mesh.cells.push_back(cell);
        std::array<std::int64_t, 8> nodes;
        std::array<std::uint8_t, 8> wrap{};
        for (int c = 0; c < 8; ++c) {
          const Cell line{i + corner_line(c, 0), j + corner_line(c, 1), k + corner_line(c, 2)};
          nodes[c] = grid.node(line[0], line[1], line[2]);
          for (int axis = 0; axis < 3; ++axis)
            if (grid.periodic(axis) && line[axis] == grid.cells(axis)) wrap[c] |= static_cast<std::uint8_t>(1 << axis);
          auto& r = rank[static_cast<std::size_t>(nodes[c])];
          r = std::min<std::uint8_t>(r, interface_element ? 0 : 1);
        }
        corners.push_back(nodes);
        interface_elements.push_back(interface_element);
        mesh.wrap.push_back(wrap);
      }

  if (rates && hole) mesh.level = rate_levels(*rates, layers_from(corners, rank.size(), interface_elements));
  const std::vector<int> place = sorting_keys(rank, mesh.level, corners);
  std::vector<std::int64_t> order;
  for (std::size_t n = 0; n < rank.size(); ++n)
    if (rank[n] < 2) order.push_back(static_cast<std::int64_t>(n));
  std::stable_sort(order.begin(), order.end(), [&](auto a, auto b) { return place[a] < place[b]; });
  mesh.node_of_grid.assign(rank.size(), -1);
  for (const std::int64_t n : order) {
    mesh.node_of_grid[n] = static_cast<std::int32_t>(mesh.nodes.size());
    mesh.nodes.push_back(grid.node_position(n));
  }
  for (const auto& nodes : corners) {
    std::array<std::int32_t, 8> element;
    for (int c = 0; c < 8; ++c) element[c] = mesh.node_of_grid[nodes[c]];
    mesh.elements.push_back(element);
  }
  return mesh;
}

std::int32_t HexMesh::element_at(const Cell& cell) const {
  const std::size_t nx = grid.cells(0), ny = grid.cells(1);
  return element_of_cell[cell[0] + nx * (cell[1] + ny * static_cast<std::size_t>(cell[2]))];
}

Stencil HexMesh::stencil(const Zone& zone, const Point& x) const { return stencil(zone, x, x); }

Stencil HexMesh::stencil(const Zone& zone, const Point& x, const Point& at) const {
  Cell cell = grid.locate(x);
  if (element_at(cell) < 0) {
    // in the hole: step across the nearest face of the hole into the continuum
    const Box& hole = zone.inner();
    int axis_out = -1;
    bool high = false;
    double nearest = scene::infinity;
    for (int axis = 0; axis < 3; ++axis) {
      if (x[axis] - hole.lo[axis] < nearest) nearest = x[axis] - hole.lo[axis], axis_out = axis, high = false;
      if (hole.hi[axis] - x[axis] < nearest) nearest = hole.hi[axis] - x[axis], axis_out = axis, high = true;
    }
    const auto& lines = grid.lines(axis_out);
    const double border = high ? hole.hi[axis_out] : hole.lo[axis_out];
    const auto line = std::min_element(lines.begin(), lines.end(), [&](double a, double b) {
      return std::fabs(a - border) < std::fabs(b - border);
    });
    cell[axis_out] = static_cast<int>(line - lines.begin()) - (high ? 0 : 1);
  }
  Stencil stencil = grid.stencil(cell, at);
  for (auto& n : stencil.node) n = node_of_grid[n];
  return stencil;
}

}  // namespace gabion::coupler
