#pragma once
// Search for pairs of spheres that are near one another.

#include <array>
#include <compare>
#include <cstdint>
#include <span>
#include <vector>

#include "protocol/engine/vec.hpp"

namespace gabion::dem {

using engine::cross;
using engine::dot;
using engine::norm;
using engine::splat;
using engine::sum;
using engine::Vec;
using engine::vec;
using engine::VecField;

/// The box of the ground, which repeats in the periodic directions; the others are unbounded.
struct Domain {
  Vec lo{}, hi{};  ///< m; used in periodic directions only
  bool periodic[3] = {false, false, false};

  double period(int axis) const { return hi[axis] - lo[axis]; }

  /// Smallest image of a difference of positions. Right for pairs nearer than half a period; a pair
  /// that may meet across several images carries Pair::image instead.
  Vec shift(Vec d) const {
    for (int axis = 0; axis < 3; ++axis)
      if (periodic[axis]) d[axis] -= period(axis) * std::nearbyint(d[axis] / period(axis));
    return d;
  }

  /// Vector of a number of periods, m.
  Vec offset(const std::array<std::int8_t, 3>& image) const {
    Vec d{};
    for (int axis = 0; axis < 3; ++axis)
      if (image[axis] != 0) d[axis] = image[axis] * period(axis);
    return d;
  }
};

/// Two spheres, i < j; the second one stands at centre_j + image * period. A sphere that meets itself
/// across a short box has i == j and an image that is lexicographically above zero.
struct Pair {
  std::int32_t i = 0, j = 0;
  std::array<std::int8_t, 3> image{};

  friend auto operator<=>(const Pair&, const Pair&) = default;
};

/// All pairs with |x_j + image * period - x_i| <= r_i + r_j + margin, each distinct image once, sorted
/// by (i, j, image). Centres may lie outside the box. Throws std::invalid_argument for a position that
/// is not finite, a negative radius or margin, a period that is not positive, or a sphere more than
/// 60 periods away from the box.
std::vector<Pair> find_pairs(std::span<const Vec> centres, std::span<const double> radii, double margin,
                             const Domain& domain);

}  // namespace gabion::dem
