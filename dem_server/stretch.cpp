// DemEngine: homogeneous strain of a periodic ground, between steps.
//
//   x' = x + E (x - c)                 positions, box and images; c the centre of the box
//   D' = D + E (D - a_j + a_i)         branches: with du kept, the branch at rest takes the whole of the change
//   |B'|^2 - rest^2 = |B|^2 - rest^2 + (B + B').(B' - B)
//
//   D  branch as it stands [m]    B  the same without displacements [m]    E  strain along x, y, z
//   a  arm of a grain in its clump [m], 0 for single ones: a clump moves with its centre and keeps its shape
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

  find_levers();
  const Vec* lever = contact_.lever.empty() ? nullptr : contact_.lever.data();
  ContactTable& table = contact_.table;
  const VecField& u = motion.displacement;
#pragma omp parallel for schedule(static) num_threads(threads) if (threads > 1)
  for (std::size_t i = 0; i < grains_.size(); ++i)
    for (std::int32_t c = table.start[i]; c < table.start[i + 1]; ++c) {
      Vec branch = table.branch[c];
      const double rest = branch[3];
      branch[3] = 0.0;
      const auto j = static_cast<std::size_t>(table.second[c]);
      Vec carried = branch + (u[j] - u[i]);
      if (lever != nullptr) carried -= lever[j] - lever[i];
      const Vec more = strain * carried;
      table.spring[c][3] += dot(branch + branch + more, more);
      branch += more;
      branch[3] = rest;
      table.branch[c] = branch;
    }
#pragma omp parallel for schedule(static) num_threads(threads) if (threads > 1)
  for (std::size_t i = 0; i < grains_.size(); ++i) {
    const Vec body = motion.position[i] + u[i] - (lever != nullptr ? lever[i] : Vec{});
    motion.position[i] += strain * (body - centre);
  }

  if (past_step_ > 0.0) contact_.strain_rate = strain / ((splat(1.0) + strain) * splat(past_step_));
  strain_at_build_ += std::max({std::fabs(strain[0]), std::fabs(strain[1]), std::fabs(strain[2])});
}

/// Arms of the clumps' members as they stand.
void DemEngine::find_levers() {
  if (clumps_.empty()) {
    contact_.lever.clear();
    return;
  }
  contact_.lever.assign(grains_.size(), Vec{});
  for (std::size_t b = 0; b < clumps_.size(); ++b) {
    const std::span<const std::int32_t> members = clumps_.members(b);
    for (std::size_t k = 0; k < members.size(); ++k) contact_.lever[members[k]] = clumps_.arm(b, k);
  }
}

/// Square of the way a grain may go before pairs are searched anew: half the skin, less half of what the strain
/// since the last search has brought the farthest pair together. Below zero: now.
double DemEngine::search_limit() const {
  double left = 0.5 * skin_;
  if (strain_at_build_ > 0.0) {
    const double largest = *std::max_element(grains_.radius.begin(), grains_.radius.end());
    double longest = 0.0;  // arm
    for (const Vec arm : contact_.lever) longest = std::max(longest, dot(arm, arm));
    longest = std::sqrt(longest);
    left -= 0.5 * strain_at_build_ * (2.0 * (largest + longest) + skin_) * (1.0 + strain_at_build_);
  }
  return left < 0.0 ? -1.0 : left * left;
}

}  // namespace gabion::dem
