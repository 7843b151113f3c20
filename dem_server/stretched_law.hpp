#pragma once
// A contact law on a periodic ground that is strained homogeneously between steps (DemEngine::stretch).
//
//   B  = D - (a_j - a_i)           branch between the bodies: a the arm of a grain in its clump, 0 for single ones
//   dv = v_j - v_i + rate * B      v: beyond the homogeneous motion, rate: strain rate along x, y, z
//   W  = sum of f_x B_x, f_y B_y, f_z B_z over the contacts: the volume times the mean normal stresses
//
// A marker on the law, so that the loops of an ordinary run stay as they are.

#include "dem_server/vector_kernels.hpp"

namespace gabion::dem {

template <class Law>
struct Stretched : Law {};

template <class Law>
inline constexpr bool is_stretched = false;
template <class Law>
inline constexpr bool is_stretched<Stretched<Law>> = true;

/// B; lever: arms of the grains, null when all are single.
template <class Law>
inline engine::Vec carried_branch(const engine::Vec* lever, std::size_t i, std::size_t j, engine::Vec branch) {
  if constexpr (is_stretched<Law>)
    if (lever != nullptr) return branch - (lever[j] - lever[i]);
  return branch;
}

/// Of the two ends of a branch. difference: of their own velocities; branch: B.
template <class Law>
inline engine::Vec relative_velocity(engine::Vec difference, engine::Vec strain_rate, engine::Vec branch) {
  if constexpr (is_stretched<Law>) return fma(strain_rate, branch, difference);
  return difference;
}

}  // namespace gabion::dem
