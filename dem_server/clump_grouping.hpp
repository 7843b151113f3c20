#pragma once
// Which neighbouring spheres make a clump.
//
// Seeds are taken by height, then y, then x. From a seed the clump grows by the unassigned sphere of the same material
// that touches one of its members and whose centre is nearest to the clump's centre of volume, until it has the size of
// the material or no such sphere is left: compact shapes, as crushed gravel has. What stays alone in the end joins the
// smallest clump of its material that it touches, then the nearest one; what touches none stays a single sphere.
//
// Every choice rests on positions, ties on the order of the seeds: the numbering of the grains has no say.

#include <array>
#include <cstdint>
#include <vector>

#include "dem_server/grains.hpp"

namespace gabion::dem {

/// Clumps of two spheres or more, one after another; members in the order in which they joined.
struct ClumpGrouping {
  std::vector<std::int32_t> start{0};             ///< members of clump b: [start[b], start[b+1])
  std::vector<std::int32_t> grain;                ///< of each member
  std::vector<std::array<std::int8_t, 3>> image;  ///< of each member, in periods from the place of its grain

  std::size_t size() const { return start.size() - 1; }
};

/// What clumps are made from.
struct ClumpRequest {
  std::vector<std::int32_t> sizes;   ///< spheres in a clump, by material, at least 1; 1: single spheres
  double gap = 0.0;                  ///< largest gap of two spheres that touch, over the sum of their radii
  std::vector<std::int32_t> single;  ///< grains that join no clump
};

/// grains: radii and materials. Throws std::invalid_argument as find_pairs.
ClumpGrouping group_clumps(const Grains& grains, const VecField& position, const Domain& domain,
                           const ClumpRequest& request);

/// What came of it.
struct Clumped {
  std::uint64_t clumps = 0, grains = 0;  ///< clumps, and spheres in them
  double aspect_ratio = 0.0;             ///< mean of length over least width along the principal axes; 0 without clumps
};
Clumped count_clumps(const ClumpGrouping& grouping, const Grains& grains, const VecField& position,
                     const Domain& domain);

}  // namespace gabion::dem
