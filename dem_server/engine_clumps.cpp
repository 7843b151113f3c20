// DemEngine: clumps from what was set, and what cannot go with them.

#include <string>

#include "dem_server/engine.hpp"

namespace gabion::dem {

using engine::RequestError;

Clumped DemEngine::make_clumps(const ClumpRequest& request) {
  if (grains_.size() == 0) throw RequestError("CLUMPS", "there are no grains", "send GRAINS first");
  for (std::size_t m = 0; m < request.sizes.size(); ++m)
    if (request.sizes[m] < 1)
      throw RequestError("CLUMPS clump_size",
                         "material " + std::to_string(m) + " has clumps of " + std::to_string(request.sizes[m]),
                         "send 1 for single spheres, or more");
  for (const std::int32_t m : grains_.material)
    if (m < 0 || static_cast<std::size_t>(m) >= request.sizes.size())
      throw RequestError("CLUMPS clump_size", "there is none for material " + std::to_string(m),
                         "send one size for every material that grains use");
  for (const std::int32_t g : request.single)
    if (g < 0 || static_cast<std::size_t>(g) >= grains_.size())
      throw RequestError("CLUMPS single",
                         "grain " + std::to_string(g) + " of " + std::to_string(grains_.size()) + " does not exist",
                         "send indices into GRAINS");
  if (!(request.gap >= 0.0) || request.gap > 1.0)
    throw RequestError("CLUMPS gap", "gap is " + std::to_string(request.gap), "give 0 to 1 times the sum of the radii");
  ClumpGrouping grouping;
  try {
    grouping = group_clumps(grains_, motion.position, domain(), request);
  } catch (const std::invalid_argument& error) {
    throw RequestError("GRAINS position", error.what(), "check positions, radii and the periodic box");
  }
  const Clumped made = count_clumps(grouping, grains_, motion.position, domain());
  clumps_.set(std::move(grouping), grains_.size());
  if (!clumps_.empty()) clumps_.drop_internal(bonds_);
  built_ = false;
  return made;
}

/// Tie, weights, constraints and dashpots act on single points: a member of a body must not meet them.
void DemEngine::refuse_bound_clumps() const {
  const std::int32_t bound = clumps_.first_bound_member(motion, interface_limit());
  if (bound < 0) return;
  throw RequestError("CLUMPS",
                     "grain " + std::to_string(bound) +
                         " belongs to a clump and is tied to the interface, shares its weight with the continuum, is "
                         "held or has a dashpot",
                     "keep materials with clumps away from the overlap and the border, or name the grain in "
                     "CLUMPS.single");
}

}  // namespace gabion::dem
