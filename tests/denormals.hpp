#pragma once
// Counts denormal numbers, for tests of what must not have any.

#include <bit>
#include <cstdint>

#include "protocol/engine/vec.hpp"

namespace gabion {

inline bool denormal(double x) {
  const auto bits = std::bit_cast<std::uint64_t>(x);
  return (bits & 0x7ff0000000000000ull) == 0 && (bits & 0x000fffffffffffffull) != 0;
}

inline std::size_t denormals(const engine::VecField& field) {
  std::size_t count = 0;
  for (const engine::Vec v : field)
    for (int axis = 0; axis < 3; ++axis) count += denormal(v[axis]);
  return count;
}

}  // namespace gabion
