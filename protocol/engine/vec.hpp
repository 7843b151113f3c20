#pragma once
// Three-component vectors padded to four doubles, so that one load fetches a point.

#include <cmath>
#include <vector>

namespace gabion::engine {

/// x, y, z, 0. Arithmetic is component by component (a GCC/Clang vector type).
using Vec = double __attribute__((vector_size(32)));

using VecField = std::vector<Vec>;

inline Vec vec(double x, double y, double z) { return Vec{x, y, z, 0.0}; }
inline Vec splat(double s) { return Vec{s, s, s, s}; }

/// Sum of x, y, z; the padding is ignored.
inline double sum(Vec a) { return a[0] + a[1] + a[2]; }
inline double dot(Vec a, Vec b) { return sum(a * b); }
inline double norm(Vec a) { return std::sqrt(dot(a, a)); }

inline Vec cross(Vec a, Vec b) {
  const Vec a_yzx = __builtin_shufflevector(a, a, 1, 2, 0, 3);
  const Vec b_yzx = __builtin_shufflevector(b, b, 1, 2, 0, 3);
  const Vec c = a * b_yzx - a_yzx * b;
  return __builtin_shufflevector(c, c, 1, 2, 0, 3);
}

}  // namespace gabion::engine
