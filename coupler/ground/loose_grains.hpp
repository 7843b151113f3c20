#pragma once
// Grains that a zone's face leaves with too few contacts: they would hang on one or two neighbours and never rest.

#include <array>
#include <cstdint>
#include <vector>

#include "coupler/ground/grains.hpp"

namespace gabion::coupler {

/// Pairs of grains whose centres are at most (1 + gap) times the sum of their radii apart, each once, i < j.
/// Periodic directions of the box repeat. Not sorted.
std::vector<std::array<std::int32_t, 2>> contact_pairs(const Packing& packing, const scene::Ground& ground);

/// Takes grains out of kept (one flag a grain of the packing): those that the cut, or an earlier removal, robbed of a
/// contact and that have fewer than least left. Grains flagged in held stay. Returns how many went.
std::size_t drop_loose_grains(const std::vector<std::array<std::int32_t, 2>>& pairs, const std::vector<char>& held,
                              std::uint32_t least, std::vector<char>& kept);

}  // namespace gabion::coupler
