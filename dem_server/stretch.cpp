// DemEngine: homogeneous strain of a periodic ground, between steps.
//
//   x' = x + E (x - c)                 positions, box and images; c the centre of the box
//   D' = D + E D                       branches: with du kept, the branch at rest takes the whole of E D
//   |B'|^2 - rest^2 = |B|^2 - rest^2 + (B + B').E D
//
//   D  branch as it stands [m]    B  the same without displacements [m]    E  strain along x, y, z
//
// Velocities are those beyond the homogeneous motion, so the grains feel contacts only: no term of the
// strain's own acceleration (Parrinello & Rahman 1981 without the term of relative order rate * dt).

#include <algorithm>
#include <cmath>
#include <string>

#include "dem_server/engine.hpp"

namespace gabion::dem {

using engine::RequestError;

void DemEngine::allow_stretch() {
  const char* where = "laboratory test";
  if (!built_) throw RequestError(where, "the engine is not prepared", "send PREPARE first");
  if (contact_options_.geometry == Geometry::frozen)
    throw RequestError(where, "contacts are frozen", "use geometry 'updated'");
  for (int axis = 0; axis < 3; ++axis)
    if (!built_domain_.periodic[axis])
      throw RequestError(where, "the ground does not repeat in every direction", "make it periodic in x, y and z");
  if (!walls_.empty() || block_.present() || tie.mode() != engine::Tie::Mode::none || sponge_.reach() > 0)
    throw RequestError(where, "there are walls, a block or a tie", "test grains alone");
  if (norm(options.gravity) > 0.0) throw RequestError(where, "gravity acts", "set it to 0");
  contact_.stretched = true;
}

void DemEngine::stretch(Vec strain) {
  strain[3] = 0.0;
  const Vec centre = splat(0.5) * (options.box_lo + options.box_hi);
  for (Vec* corner : {&options.box_lo, &options.box_hi}) *corner += strain * (*corner - centre);
  built_options_.box_lo = built_domain_.lo = options.box_lo;
  built_options_.box_hi = built_domain_.hi = options.box_hi;

  ContactTable& table = contact_.table;
  const VecField& u = motion.displacement;
#pragma omp parallel for schedule(static) num_threads(threads) if (threads > 1)
  for (std::size_t i = 0; i < grains_.size(); ++i)
    for (std::int32_t c = table.start[i]; c < table.start[i + 1]; ++c) {
      Vec branch = table.branch[c];
      const double rest = branch[3];
      branch[3] = 0.0;
      const Vec more = strain * (branch + (u[table.second[c]] - u[i]));
      table.spring[c][3] += dot(branch + branch + more, more);
      branch += more;
      branch[3] = rest;
      table.branch[c] = branch;
    }
#pragma omp parallel for schedule(static) num_threads(threads) if (threads > 1)
  for (std::size_t i = 0; i < grains_.size(); ++i) motion.position[i] += strain * (motion.position[i] + u[i] - centre);

  if (past_step_ > 0.0) contact_.strain_rate = strain / ((splat(1.0) + strain) * splat(past_step_));
  strain_at_build_ += std::max({std::fabs(strain[0]), std::fabs(strain[1]), std::fabs(strain[2])});
}

/// Square of the way a grain may go before pairs are searched anew: half the skin, less half of what the strain
/// since the last search has brought the farthest pair together. Below zero: now.
double DemEngine::search_limit() const {
  double left = 0.5 * skin_;
  if (strain_at_build_ > 0.0) {
    const double largest = *std::max_element(grains_.radius.begin(), grains_.radius.end());
    left -= 0.5 * strain_at_build_ * (2.0 * largest + skin_) * (1.0 + strain_at_build_);
  }
  return left < 0.0 ? -1.0 : left * left;
}

}  // namespace gabion::dem
