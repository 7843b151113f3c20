#pragma once
// The linear springs of a bonded packing.

#include <array>
#include <span>
#include <vector>

#include "dem_server/neighbours.hpp"

namespace gabion::dem {

/// A bond, stress-free as it stands. The contact point lies a_i from the centre of i along the normal.
struct Bond {
  std::int32_t i = 0, j = 0;
  Vec normal{};                 ///< unit, from i to (the image of) j
  double a_i = 0.0, a_j = 0.0;  ///< r + gap/2 each, so that they sum to the distance, m
  double k_n = 0.0, k_s = 0.0;  ///< stiffness of the contact, N/m

  double distance() const { return a_i + a_j; }
  Vec branch() const { return splat(a_i + a_j) * normal; }  ///< from centre to centre, m
};

struct BondNetwork {
  VecField centres;             ///< m
  std::vector<double> radii;    ///< m
  std::vector<double> density;  ///< of each grain, kg/m3; empty counts as 1
  std::vector<Bond> bonds;
  std::vector<std::uint8_t> locked = {};  ///< 1 where a grain does not rotate; empty: all do

  std::size_t size() const { return centres.size(); }
  double contacts_per_grain() const;
  double mean_radius() const;
};

/// Stiffness of the grains over their radius, N/m2; one entry for all, or one for each grain.
struct StiffnessCoefficients {
  std::vector<double> normal, shear;
};

/// Bonds every pair with distance <= (r_i + r_j)(1 + gap). At a contact the two grains are in series:
/// k = k_i k_j/(k_i + k_j) with k_i = coefficient_i r_i. Throws engine::RequestError for sizes that do
/// not fit or coefficients that are negative.
BondNetwork make_bond_network(const VecField& centres, std::span<const double> radii, const Domain& domain, double gap,
                              const StiffnessCoefficients& coefficients);

}  // namespace gabion::dem
