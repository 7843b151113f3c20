#pragma once
// The stable step of leapfrog, 2/omega_max.
//
// Source: Lanczos (1950), Paige (1972) on A = F M^-1/2 K M^-1/2 F, F the freedom of each component. The largest
// Ritz value theta has an eigenvalue of A within r = beta_k |s_k| of it; omega_max^2 is taken as theta + r when r
// is below the tolerance, so the step is below the limit by at most half of it, and the iteration goes on long
// enough for localised modes (free corners) to show.
//
//   theta, s  Ritz value [1/s2], last component of its vector    beta_k  norm of the k-th residual [1/s2]

#include <functional>

#include "protocol/engine/motion.hpp"

namespace gabion::continuum {

/// force := -K u
using StiffnessProduct = std::function<void(const engine::VecField& displacement, engine::VecField& force)>;

/// omega_max^2, 1/s2, from above; needs mass and freedom of the motion. 0 when nothing can move.
double largest_squared_frequency(const engine::Motion& motion, const StiffnessProduct& product);

}  // namespace gabion::continuum
