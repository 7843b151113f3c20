#include "dem_server/packing/homogeneity.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "dem_server/packing/window.hpp"

namespace gabion::dem {

std::vector<double> slice_fractions(const VecField& centres, std::span<const double> radii, const Domain& box, int axis,
                                    int slices) {
  std::vector<double> fractions;
  // Only the sliced direction cuts: the others hold every sphere whole
  Domain along = box;
  Window slice{box.lo, box.hi};
  for (int a = 0; a < 3; ++a) along.periodic[a] = a == axis ? box.periodic[a] : true;
  const double thickness = (box.hi[axis] - box.lo[axis]) / slices;
  for (int k = 0; k < slices; ++k) {
    slice.lo[axis] = box.lo[axis] + k * thickness;
    slice.hi[axis] = k + 1 < slices ? slice.lo[axis] + thickness : box.hi[axis];
    fractions.push_back(solid_fraction(centres, radii, along, slice));
  }
  return fractions;
}

std::array<double, 6> fabric_tensor(const VecField& centres, std::span<const double> radii, const Domain& domain,
                                    double gap) {
  double largest = 0.0;
  for (const double r : radii) largest = std::max(largest, r);
  std::array<double, 6> fabric{};
  double contacts = 0.0;
  for (const Pair& pair : find_pairs(centres, radii, 2.0 * largest * gap, domain)) {
    const Vec d = centres[pair.j] + domain.offset(pair.image) - centres[pair.i];
    const double distance = norm(d);
    if (distance > (radii[pair.i] + radii[pair.j]) * (1.0 + gap) || distance == 0.0) continue;
    const Vec n = d / splat(distance);
    const double products[6] = {n[0] * n[0], n[1] * n[1], n[2] * n[2], n[1] * n[2], n[2] * n[0], n[0] * n[1]};
    for (int k = 0; k < 6; ++k) fabric[k] += products[k];
    contacts += 1.0;
  }
  if (contacts > 0.0)
    for (double& f : fabric) f /= contacts;
  return fabric;
}

double inner_solid_fraction(const VecField& centres, std::span<const double> radii, const Domain& box) {
  double largest = 0.0;
  for (const double r : radii) largest = std::max(largest, r);
  Window inner{box.lo, box.hi};
  for (int a = 0; a < 3; ++a) {
    if (box.periodic[a]) continue;
    inner.lo[a] += 2.0 * largest;
    inner.hi[a] -= 2.0 * largest;
    if (inner.hi[a] <= inner.lo[a]) return std::numeric_limits<double>::quiet_NaN();
  }
  return solid_fraction(centres, radii, box, inner);
}

}  // namespace gabion::dem
