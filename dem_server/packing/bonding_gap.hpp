#pragma once
// Which grains of a packing take part, and up to which gap they are bonded.

#include <cstdint>
#include <span>
#include <vector>

#include "dem_server/neighbours.hpp"
#include "protocol/engine/vec.hpp"

namespace gabion::dem {

struct BondingGap {
  double gap = 0.0;                 ///< bond where distance <= (r_i + r_j)(1 + gap); never negative
  double contacts_per_grain = 0.0;  ///< mean over the kept grains that count
  std::vector<std::uint8_t> kept;   ///< 0 for rattlers: fewer than min_contacts bonds with kept grains, or not
                                    ///< connected with the largest part; all 1 for min_contacts = 0
};

/// The gap that gives the mean number of contacts over the kept grains that is nearest to the target.
/// Grains nearer than one largest diameter to a flat face do not count in the mean (unless all are), so
/// that the same gap makes the same material in any box; domain.lo and hi are the faces.
/// Overlapping grains cannot be left unbonded: where these alone give more than the target the gap is 0
/// and contacts_per_grain says what there is.
BondingGap find_bonding_gap(const engine::VecField& centres, std::span<const double> radii, const Domain& domain,
                            double contacts_per_grain, unsigned min_contacts);

}  // namespace gabion::dem
