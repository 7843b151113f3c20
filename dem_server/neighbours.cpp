#include "dem_server/neighbours.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>

namespace gabion::dem {
namespace {

using Image = std::array<std::int8_t, 3>;

/// A sphere, or one of its periodic images, as seen from inside the box.
struct Point {
  Vec x;
  double radius;
  std::int32_t grain;
  Image image;  ///< periods from the wrapped centre
};

/// A uniform grid over the spheres of about one size and their images.
class Grid {
 public:
  Grid(std::vector<Point> points, double cell) : points_(std::move(points)) {
    Vec lo = points_.front().x, hi = lo;
    for (const Point& p : points_)
      for (int axis = 0; axis < 3; ++axis) {
        lo[axis] = std::min(lo[axis], p.x[axis]);
        hi[axis] = std::max(hi[axis], p.x[axis]);
      }
    lo_ = lo;
    // few spheres spread far apart must not ask for more cells than there are spheres
    const double wanted = 8.0 * static_cast<double>(points_.size()) + 64.0;
    const auto cells_with = [&](double size) {
      double cells = 1.0;
      for (int axis = 0; axis < 3; ++axis) cells *= std::floor((hi[axis] - lo[axis]) / size) + 1.0;
      return cells;
    };
    while (cells_with(cell) > wanted) cell *= 2.0;
    inverse_cell_ = 1.0 / cell;
    for (int axis = 0; axis < 3; ++axis)
      extent_[axis] = static_cast<std::int64_t>((hi[axis] - lo[axis]) * inverse_cell_) + 1;
    sort_into_cells();
  }

  /// Calls visit(point) for every point in the 27 cells round x, in a fixed order.
  template <typename Visit>
  void around(Vec x, Visit&& visit) const {
    std::int64_t first[3], last[3];
    for (int axis = 0; axis < 3; ++axis) {
      const double c = std::floor((x[axis] - lo_[axis]) * inverse_cell_);
      const double top = static_cast<double>(extent_[axis]);
      if (c < -1.0 || c > top) return;
      first[axis] = std::max<std::int64_t>(static_cast<std::int64_t>(c) - 1, 0);
      last[axis] = std::min<std::int64_t>(static_cast<std::int64_t>(c) + 1, extent_[axis] - 1);
    }
    for (std::int64_t z = first[2]; z <= last[2]; ++z)
      for (std::int64_t y = first[1]; y <= last[1]; ++y) {
        const std::int64_t row = (z * extent_[1] + y) * extent_[0];
        // cells along x are neighbours in memory
        for (std::int32_t k = start_[row + first[0]]; k < start_[row + last[0] + 1]; ++k) visit(sorted_[k]);
      }
  }

 private:
  std::int64_t cell_of(Vec x) const {
    std::int64_t c[3];
    for (int axis = 0; axis < 3; ++axis)
      c[axis] = std::clamp<std::int64_t>(static_cast<std::int64_t>((x[axis] - lo_[axis]) * inverse_cell_), 0,
                                         extent_[axis] - 1);
    return (c[2] * extent_[1] + c[1]) * extent_[0] + c[0];
  }

  void sort_into_cells() {
    const std::int64_t cells = extent_[0] * extent_[1] * extent_[2];
    start_.assign(cells + 1, 0);
    std::vector<std::int64_t> cell(points_.size());
    for (std::size_t p = 0; p < points_.size(); ++p) ++start_[(cell[p] = cell_of(points_[p].x)) + 1];
    for (std::int64_t c = 0; c < cells; ++c) start_[c + 1] += start_[c];
    std::vector<std::int32_t> next(start_.begin(), start_.end() - 1);
    sorted_.resize(points_.size());
    for (std::size_t p = 0; p < points_.size(); ++p) sorted_[next[cell[p]]++] = points_[p];
    points_ = {};
  }

  std::vector<Point> points_, sorted_;
  std::vector<std::int32_t> start_;
  Vec lo_{};
  double inverse_cell_ = 0.0;
  std::int64_t extent_[3] = {1, 1, 1};
};

std::string name_of(std::size_t grain) {
  return "grain " + std::to_string(grain);
}

/// Centres brought into the box, and by how many periods.
struct Wrapped {
  std::vector<Vec> x;
  std::vector<Image> periods;
};

Wrapped wrap(std::span<const Vec> centres, const Domain& domain) {
  constexpr double most_periods = 60.0;  // differences of two must fit eight bits
  Wrapped wrapped{{centres.begin(), centres.end()}, std::vector<Image>(centres.size())};
  for (std::size_t i = 0; i < centres.size(); ++i)
    for (int axis = 0; axis < 3; ++axis) {
      if (!std::isfinite(centres[i][axis])) throw std::invalid_argument(name_of(i) + ": its position is not finite");
      if (!domain.periodic[axis]) continue;
      const double periods = std::floor((centres[i][axis] - domain.lo[axis]) / domain.period(axis));
      if (std::fabs(periods) > most_periods)
        throw std::invalid_argument(name_of(i) + " is " + std::to_string(periods) + " periods outside the box");
      wrapped.x[i][axis] -= periods * domain.period(axis);
      wrapped.periods[i][axis] = static_cast<std::int8_t>(periods);
    }
  return wrapped;
}

/// Adds the images of a point that lie within reach of the box.
void add_images(std::vector<Point>& points, const Point& point, double reach, const Domain& domain) {
  int most[3];
  for (int axis = 0; axis < 3; ++axis)
    most[axis] = domain.periodic[axis] ? static_cast<int>(std::ceil(reach / domain.period(axis))) : 0;
  for (int kx = -most[0]; kx <= most[0]; ++kx)
    for (int ky = -most[1]; ky <= most[1]; ++ky)
      for (int kz = -most[2]; kz <= most[2]; ++kz) {
        Point image = point;
        image.image = {static_cast<std::int8_t>(kx), static_cast<std::int8_t>(ky), static_cast<std::int8_t>(kz)};
        image.x += domain.offset(image.image);
        bool near = true;
        for (int axis = 0; axis < 3; ++axis)
          if (domain.periodic[axis])
            near = near && image.x[axis] >= domain.lo[axis] - reach && image.x[axis] <= domain.hi[axis] + reach;
        if (near) points.push_back(image);
      }
}

constexpr int most_levels = 12;

/// Spheres of similar size share a grid; a sphere looks into its own grid and those of larger ones.
std::vector<int> levels_by_size(std::span<const double> radii, double margin) {
  double largest = 0.0;
  for (const double r : radii) largest = std::max(largest, r);
  const double widest = 2.0 * largest + margin;
  std::vector<int> level(radii.size(), 0);
  for (std::size_t i = 0; i < radii.size(); ++i) {
    const double width = 2.0 * radii[i] + margin;
    double limit = 0.4 * widest;  // a size ratio of 2 stays in one grid
    while (width < limit && level[i] < most_levels - 1) {
      limit *= 0.4;
      ++level[i];
    }
  }
  return level;
}

void sort_pairs(std::vector<Pair>& pairs, std::size_t grains) {
  std::vector<std::size_t> start(grains + 1, 0);
  for (const Pair& p : pairs) ++start[p.i + 1];
  for (std::size_t i = 0; i < grains; ++i) start[i + 1] += start[i];
  std::vector<Pair> sorted(pairs.size());
  std::vector<std::size_t> next(start.begin(), start.end() - 1);
  for (const Pair& p : pairs) sorted[next[p.i]++] = p;
  for (std::size_t i = 0; i < grains; ++i) std::sort(sorted.begin() + start[i], sorted.begin() + start[i + 1]);
  pairs = std::move(sorted);
}

Pair ordered(std::int32_t a, std::int32_t b, const Image& image) {
  if (a <= b) return {a, b, image};
  return {
      b,
      a,
      {static_cast<std::int8_t>(-image[0]), static_cast<std::int8_t>(-image[1]), static_cast<std::int8_t>(-image[2])}};
}

void check(std::span<const Vec> centres, std::span<const double> radii, double margin, const Domain& domain) {
  if (centres.size() != radii.size()) throw std::invalid_argument("as many radii as centres are needed");
  if (!(margin >= 0.0)) throw std::invalid_argument("the search margin must not be negative");
  for (int axis = 0; axis < 3; ++axis)
    if (domain.periodic[axis] && !(domain.period(axis) > 0.0))
      throw std::invalid_argument("the period along axis " + std::to_string(axis) + " must be positive");
  for (std::size_t i = 0; i < radii.size(); ++i)
    if (!(radii[i] >= 0.0)) throw std::invalid_argument(name_of(i) + ": its radius must not be negative");
}

}  // namespace

std::vector<Pair> find_pairs(std::span<const Vec> centres, std::span<const double> radii, double margin,
                             const Domain& domain) {
  check(centres, radii, margin, domain);
  std::vector<Pair> pairs;
  const Wrapped wrapped = wrap(centres, domain);
  const std::vector<int> level = levels_by_size(radii, margin);
  for (int large = 0; large < most_levels; ++large) {
    double cell = 0.0;
    for (std::size_t i = 0; i < radii.size(); ++i)
      if (level[i] == large) cell = std::max(cell, 2.0 * radii[i] + margin);
    if (cell == 0.0) continue;
    cell *= 1.0 + 1e-9;  // round-off must not push a touching pair two cells apart
    std::vector<Point> points;
    for (std::size_t i = 0; i < radii.size(); ++i)
      if (level[i] == large)
        add_images(points, {wrapped.x[i], radii[i], static_cast<std::int32_t>(i), {}}, cell, domain);
    const Grid grid(std::move(points), cell);
    for (std::size_t i = 0; i < radii.size(); ++i) {
      if (level[i] < large) continue;
      const auto a = static_cast<std::int32_t>(i);
      grid.around(wrapped.x[i], [&](const Point& b) {
        // two of one level find each other twice
        if (level[i] == large && (b.grain < a || (b.grain == a && b.image <= Image{}))) return;
        const double reach = radii[i] + b.radius + margin;
        const Vec d = b.x - wrapped.x[i];
        if (dot(d, d) > reach * reach) return;
        Image image;
        for (int axis = 0; axis < 3; ++axis)
          image[axis] =
              static_cast<std::int8_t>(b.image[axis] + wrapped.periods[i][axis] - wrapped.periods[b.grain][axis]);
        pairs.push_back(ordered(a, b.grain, image));
      });
    }
  }
  sort_pairs(pairs, radii.size());
  return pairs;
}

}  // namespace gabion::dem
