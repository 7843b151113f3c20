#pragma once
// A contact law on a periodic ground that is strained homogeneously between steps (DemEngine::stretch).
//
//   dv = v_j - v_i + rate * D      v: beyond the homogeneous motion, rate: strain rate along x, y, z
//   W  = sum of f_x D_x, f_y D_y, f_z D_z over the contacts: the volume times the mean normal stresses
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

/// Of the two ends of a branch. difference: of their own velocities.
template <class Law>
inline engine::Vec relative_velocity(engine::Vec difference, engine::Vec strain_rate, engine::Vec branch) {
  if constexpr (is_stretched<Law>) return fma(strain_rate, branch, difference);
  return difference;
}

}  // namespace gabion::dem
