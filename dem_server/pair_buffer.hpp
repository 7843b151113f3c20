#pragma once
// Forces per contact, summed per grain in ascending contact order: the order in which one thread
// scatters them, so that any number of threads gives the same bits.

#include <cstdint>
#include <vector>

#include "dem_server/neighbours.hpp"

namespace gabion::dem {

struct PairBuffer {
  VecField force;   ///< on the first grain, N; fourth: arm a_i, m
  VecField moment;  ///< n x f, N; fourth: arm a_j, m; torques are a_i and a_j times it
  VecField couple;  ///< moment of rolling resistance on the first grain, N m; empty when there is none

  /// Lists, per grain, the contacts in which it is the second one.
  void connect(const std::vector<std::int32_t>& start, const std::vector<std::int32_t>& second, bool couples = false);

  /// Adds the contacts' forces to grains [first, last).
  void gather(std::size_t first, std::size_t last, bool rotating, VecField& grain_force, VecField& grain_torque,
              int threads) const;

 private:
  template <bool rotating, bool couples>
  void gather_parts(std::size_t first, std::size_t last, VecField& grain_force, VecField& grain_torque,
                    int threads) const;

  std::vector<std::int32_t> start_, second_;
  std::vector<std::int32_t> incoming_start_, incoming_;
};

}  // namespace gabion::dem
