#pragma once
// 64-bit hash of the state, for determinism tests and run summaries.

#include <cstdint>
#include <cstring>
#include <span>
#include <string_view>

#include "protocol/engine/vec.hpp"

namespace gabion::engine {

/// FNV-1a (Fowler, Noll, Vo) over 64-bit words: order matters, byte order is the machine's (little-endian).
class Hash {
 public:
  void add(std::uint64_t word) { value_ = (value_ ^ word) * 0x100000001b3ull; }
  void add(double number) {
    std::uint64_t word;
    std::memcpy(&word, &number, sizeof word);
    add(word);
  }
  void add(std::span<const Vec> field) {
    for (const Vec v : field)
      for (int axis = 0; axis < 3; ++axis) add(v[axis]);
  }
  std::uint64_t value() const { return value_ ^ (value_ >> 29); }

 private:
  std::uint64_t value_ = 0xcbf29ce484222325ull;
};

}  // namespace gabion::engine
