#pragma once
// How even and how isotropic a packing is.

#include <array>
#include <span>
#include <vector>

#include "dem_server/neighbours.hpp"

namespace gabion::dem {

/// Share of solid in equal slices of the box normal to an axis. Spheres are cut exactly by the slices'
/// planes; overlaps count twice. Spheres that reach over a periodic face count on its other side.
std::vector<double> slice_fractions(const VecField& centres, std::span<const double> radii, const Domain& box, int axis,
                                    int slices);

/// Mean of n (x) n over the pairs with distance <= (r_i + r_j)(1 + gap), n along the line of centres:
/// xx yy zz yz zx xy; isotropic is 1/3 1/3 1/3 0 0 0. All zero when no pair is that near.
std::array<double, 6> fabric_tensor(const VecField& centres, std::span<const double> radii, const Domain& domain,
                                    double gap);

/// Solid fraction of the box without a layer of one largest diameter along each flat face, where a
/// packing is looser than inside. NaN when nothing of the box is left.
double inner_solid_fraction(const VecField& centres, std::span<const double> radii, const Domain& box);

}  // namespace gabion::dem
