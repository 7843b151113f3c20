#pragma once
// Highest frequency of the linearised packing.

#include "dem_server/clumps.hpp"
#include "dem_server/linear_network.hpp"
#include "dem_server/rotation.hpp"
#include "protocol/engine/motion.hpp"

namespace gabion::dem {

struct Spectrum {
  double highest = 0.0;   ///< largest eigenvalue of M^-1 K with the residual's bound, (rad/s)^2
  double residual = 0.0;  ///< that bound over the eigenvalue
  int iterations = 0;
};

/// Lanczos on M^-1/2 K M^-1/2 over free displacements and free rotations; members of a clump move as one body,
/// u_i = U + Theta x a_i, with its mass and inertia.
Spectrum highest_eigenvalue(LinearNetwork& network, const engine::Motion& motion, const Rotation& rotation,
                            bool rotating, const Clumps* clumps = nullptr);

}  // namespace gabion::dem
