#pragma once
// Random numbers that are the same on every standard library: the generator is fixed by the C++
// standard, the distributions of <random> are not, so the transformations are our own.

#include <cstdint>
#include <random>
#include <utility>
#include <vector>

namespace gabion::dem {

class Random {
 public:
  explicit Random(std::uint64_t seed) : generator_(seed) {}

  /// Uniform in [0, 1), 53 bits.
  double uniform() { return static_cast<double>(generator_() >> 11) * 0x1.0p-53; }

  /// Uniform in {0, ..., n-1}; n > 0. Values beyond the last whole multiple of n are drawn again.
  std::uint64_t below(std::uint64_t n) {
    const std::uint64_t limit = UINT64_MAX - UINT64_MAX % n;
    std::uint64_t word = generator_();
    while (word >= limit) word = generator_();
    return word % n;
  }

  /// Fisher and Yates.
  template <class T>
  void shuffle(std::vector<T>& values) {
    for (std::size_t k = values.size(); k > 1; --k) std::swap(values[k - 1], values[below(k)]);
  }

 private:
  std::mt19937_64 generator_;
};

}  // namespace gabion::dem
