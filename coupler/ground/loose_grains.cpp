#include "coupler/ground/loose_grains.hpp"

#include <algorithm>
#include <cmath>

namespace gabion::coupler {

namespace {

constexpr double round_off = 1e-9;  // as for bonds: touching pairs are exact in no packing

/// Cells at least as wide as the largest distance of a contact; grains sorted by cell.
struct CellGrid {
  std::array<std::int64_t, 3> count{};
  std::array<double, 3> origin{}, width{};
  std::array<bool, 3> periodic{};
  std::vector<std::int32_t> start, grains;

  CellGrid(const Packing& packing, const scene::Ground& ground, double reach) : periodic(ground.periodic) {
    for (int axis = 0; axis < 3; ++axis) {
      origin[axis] = ground.box.lo[axis];
      const double length = ground.box.hi[axis] - ground.box.lo[axis];
      count[axis] = std::clamp<std::int64_t>(static_cast<std::int64_t>(length / reach), 1, 1 << 20);
      width[axis] = length / static_cast<double>(count[axis]);
    }
    start.assign(static_cast<std::size_t>(count[0] * count[1] * count[2]) + 1, 0);
    std::vector<std::size_t> cell(packing.position.size());
    for (std::size_t g = 0; g < cell.size(); ++g) {
      cell[g] = index(cell_of(packing.position[g]));
      ++start[cell[g] + 1];
    }
    for (std::size_t c = 1; c < start.size(); ++c) start[c] += start[c - 1];
    grains.resize(cell.size());
    std::vector<std::int32_t> next(start.begin(), start.end() - 1);
    for (std::size_t g = 0; g < cell.size(); ++g) grains[static_cast<std::size_t>(next[cell[g]]++)] = static_cast<std::int32_t>(g);
  }

  std::array<std::int64_t, 3> cell_of(const Point& x) const {
    std::array<std::int64_t, 3> cell;
    for (int axis = 0; axis < 3; ++axis)
      cell[axis] = std::clamp<std::int64_t>(static_cast<std::int64_t>((x[axis] - origin[axis]) / width[axis]), 0, count[axis] - 1);
    return cell;
  }
  std::size_t index(const std::array<std::int64_t, 3>& cell) const {
    return static_cast<std::size_t>((cell[2] * count[1] + cell[1]) * count[0] + cell[0]);
  }
};

}  // namespace

std::vector<std::array<std::int32_t, 2>> contact_pairs(const Packing& packing, const scene::Ground& ground) {
  std::vector<std::array<std::int32_t, 2>> pairs;
  if (packing.radius.empty()) return pairs;
  const double factor = 1.0 + packing.gap + round_off;
  const double reach = 2.0 * factor * *std::max_element(packing.radius.begin(), packing.radius.end());
  const CellGrid cells(packing, ground, reach);
  for (std::size_t g = 0; g < packing.radius.size(); ++g) {
    const Point& x = packing.position[g];
    const auto home = cells.cell_of(x);
    std::array<std::int64_t, 3> step;
    for (step[2] = -1; step[2] <= 1; ++step[2])
      for (step[1] = -1; step[1] <= 1; ++step[1])
        for (step[0] = -1; step[0] <= 1; ++step[0]) {
          std::array<std::int64_t, 3> cell;
          Point shift{};
          bool exists = true;
          for (int axis = 0; axis < 3; ++axis) {
            cell[axis] = home[axis] + step[axis];
            if (cell[axis] >= 0 && cell[axis] < cells.count[axis]) continue;
            exists = exists && cells.periodic[axis];
            const double turn = cell[axis] < 0 ? -1.0 : 1.0;
            shift[axis] = turn * cells.width[axis] * static_cast<double>(cells.count[axis]);
            cell[axis] -= static_cast<std::int64_t>(turn) * cells.count[axis];
          }
          if (!exists) continue;
          const std::size_t c = cells.index(cell);
          for (std::int32_t k = cells.start[c]; k < cells.start[c + 1]; ++k) {
            const std::int32_t other = cells.grains[static_cast<std::size_t>(k)];
            if (other <= static_cast<std::int32_t>(g)) continue;
            double square = 0.0;
            for (int axis = 0; axis < 3; ++axis)
              square += std::pow(packing.position[static_cast<std::size_t>(other)][axis] + shift[axis] - x[axis], 2);
            const double limit = factor * (packing.radius[g] + packing.radius[static_cast<std::size_t>(other)]);
            if (square <= limit * limit) pairs.push_back({static_cast<std::int32_t>(g), other});
          }
        }
  }
  return pairs;
}

std::size_t drop_loose_grains(const std::vector<std::array<std::int32_t, 2>>& pairs, const std::vector<char>& held,
                              std::uint32_t least, std::vector<char>& kept) {
  std::vector<std::uint32_t> before(kept.size(), 0), left(kept.size());
  for (const auto& [i, j] : pairs) ++before[static_cast<std::size_t>(i)], ++before[static_cast<std::size_t>(j)];
  std::size_t gone = 0;
  for (bool changed = true; changed;) {
    std::fill(left.begin(), left.end(), 0);
    for (const auto& [i, j] : pairs)
      if (kept[static_cast<std::size_t>(i)] && kept[static_cast<std::size_t>(j)])
        ++left[static_cast<std::size_t>(i)], ++left[static_cast<std::size_t>(j)];
    changed = false;
    for (std::size_t g = 0; g < kept.size(); ++g)
      if (kept[g] && !held[g] && left[g] < before[g] && left[g] < least) {
        kept[g] = 0;
        ++gone;
        changed = true;
      }
  }
  return gone;
}

}  // namespace gabion::coupler
