#pragma once
// Eight elements side by side: one vector lane an element. Nodal fields are arrays of Vec (x, y, z, 0);
// gather and scatter turn eight of them into one vector a component, and back.

#include <cstdint>

#include "protocol/engine/vec.hpp"

namespace gabion::continuum {

using engine::Vec;
using engine::VecField;

constexpr int lane_count = 8;
/// One double an element of the batch (a GCC/Clang vector type).
using Lanes = double __attribute__((vector_size(8 * lane_count)));

inline Lanes broadcast(double s) {
  return Lanes{s, s, s, s, s, s, s, s};
}

inline double sum(Lanes a) {
  double total = 0.0;
  for (int lane = 0; lane < lane_count; ++lane) total += a[lane];
  return total;
}

/// x, y, z of eight nodes.
inline void gather(const Vec* field, const std::int32_t* node, Lanes& x, Lanes& y, Lanes& z) {
  const auto pair = [&](int lane) {
    return __builtin_shufflevector(field[node[lane]], field[node[lane + 4]], 0, 1, 2, 3, 4, 5, 6, 7);
  };
  const Lanes n0 = pair(0), n1 = pair(1), n2 = pair(2), n3 = pair(3);
  const Lanes xz01 = __builtin_shufflevector(n0, n1, 0, 8, 2, 10, 4, 12, 6, 14);
  const Lanes yw01 = __builtin_shufflevector(n0, n1, 1, 9, 3, 11, 5, 13, 7, 15);
  const Lanes xz23 = __builtin_shufflevector(n2, n3, 0, 8, 2, 10, 4, 12, 6, 14);
  const Lanes yw23 = __builtin_shufflevector(n2, n3, 1, 9, 3, 11, 5, 13, 7, 15);
  x = __builtin_shufflevector(xz01, xz23, 0, 1, 8, 9, 4, 5, 12, 13);
  y = __builtin_shufflevector(yw01, yw23, 0, 1, 8, 9, 4, 5, 12, 13);
  z = __builtin_shufflevector(xz01, xz23, 2, 3, 10, 11, 6, 7, 14, 15);
}

/// Eight nodal vectors from their components, lane by lane.
inline void spread(Lanes x, Lanes y, Lanes z, Vec* out) {
  const Lanes zero{};
  const Lanes xy_even = __builtin_shufflevector(x, y, 0, 8, 2, 10, 4, 12, 6, 14);
  const Lanes xy_odd = __builtin_shufflevector(x, y, 1, 9, 3, 11, 5, 13, 7, 15);
  const Lanes z_even = __builtin_shufflevector(z, zero, 0, 8, 2, 10, 4, 12, 6, 14);
  const Lanes z_odd = __builtin_shufflevector(z, zero, 1, 9, 3, 11, 5, 13, 7, 15);
  const Lanes n04 = __builtin_shufflevector(xy_even, z_even, 0, 1, 8, 9, 4, 5, 12, 13);
  const Lanes n26 = __builtin_shufflevector(xy_even, z_even, 2, 3, 10, 11, 6, 7, 14, 15);
  const Lanes n15 = __builtin_shufflevector(xy_odd, z_odd, 0, 1, 8, 9, 4, 5, 12, 13);
  const Lanes n37 = __builtin_shufflevector(xy_odd, z_odd, 2, 3, 10, 11, 6, 7, 14, 15);
  const auto halves = [&](Lanes pair, int lane) {
    out[lane] = __builtin_shufflevector(pair, pair, 0, 1, 2, 3);
    out[lane + 4] = __builtin_shufflevector(pair, pair, 4, 5, 6, 7);
  };
  halves(n04, 0);
  halves(n15, 1);
  halves(n26, 2);
  halves(n37, 3);
}

/// The nodes that a thread may write: [first, last).
struct NodeRange {
  std::int32_t first, last;
  bool holds(std::int32_t node) const { return node >= first && node < last; }
};

/// force -= the eight nodal forces, for the nodes in own; whole says that all of them are.
inline void scatter_minus(Lanes x, Lanes y, Lanes z, const std::int32_t* node, NodeRange own, bool whole, Vec* force) {
  Vec f[lane_count];
  spread(x, y, z, f);
  if (whole) {
    for (int lane = 0; lane < lane_count; ++lane) force[node[lane]] -= f[lane];
  } else {
    for (int lane = 0; lane < lane_count; ++lane)
      if (own.holds(node[lane])) force[node[lane]] -= f[lane];
  }
}

}  // namespace gabion::continuum
