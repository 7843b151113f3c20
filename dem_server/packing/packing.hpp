#pragma once
// Makes a packing of spheres in a box; the messages PACK and PACKED.

#include <cstdint>
#include <string>
#include <vector>

#include "dem_server/neighbours.hpp"

namespace gabion::dem {

struct PackingRequest {
  Domain box;                           ///< lo and hi in every direction; flat faces where not periodic
  std::string radius_kind = "uniform";  ///< see RadiusDistribution
  std::vector<double> radius;           ///< m, and shares for sieve
  double solid_fraction = 0.63;         ///< 0.05 to 0.74, away from flat faces; above about 0.64 overlaps remain
  double contacts_per_grain = 5.7;      ///< target, 0 to 12; mean over grains away from flat faces
  unsigned min_contacts = 3;            ///< grains with fewer are removed
  std::uint64_t seed = 1;
};

struct Packing {
  VecField position;                ///< m; inside the box; whole spheres inside flat faces
  std::vector<double> radius;       ///< m
  double gap = 0.0;                 ///< bonding gap over the sum of radii
  double contacts_per_grain = 0.0;  ///< reached with this gap; above the target where overlaps alone give more;
                                    ///< grains along flat faces have fewer and are not counted
  double solid_fraction = 0.0;      ///< measured away from flat faces, before rattlers were removed
  double box_fraction = 0.0;        ///< spheres over the whole box, before rattlers were removed
  std::uint64_t rattlers = 0;       ///< grains removed
  double residual_overlap = 0.0;    ///< mean overlap of touching grains over the mean radius
  double max_overlap = 0.0;         ///< largest one over the mean radius
  double unbalanced = 0.0;          ///< rms force left on a grain over the rms contact force
  int steps = 0;                    ///< of the relaxation
};

/// Grains at random places with small radii grow and are relaxed (relaxation.hpp) at the target solid
/// fraction; then the bonding gap is chosen and rattlers are removed (bonding_gap.hpp). The same
/// request gives the same bits. Grains are ordered by place. Throws engine::RequestError with the field
/// and what is wrong, such as a box too small for the radii.
Packing make_packing(const PackingRequest& request);

}  // namespace gabion::dem
