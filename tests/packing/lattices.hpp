#pragma once
// Regular packings of equal spheres of radius 1 that touch, for the tests of this folder.

#include <array>
#include <vector>

#include "dem_server/neighbours.hpp"

namespace gabion::dem::lattice {

struct Lattice {
  VecField centres;
  std::vector<double> radii;
  Domain box;   ///< cells * side in each direction from the origin
  double side;  ///< of a cubic cell
};

inline Lattice fill(int cells, double side, const std::vector<Vec>& basis, bool periodic) {
  Lattice result;
  result.side = side;
  for (int x = 0; x < cells; ++x)
    for (int y = 0; y < cells; ++y)
      for (int z = 0; z < cells; ++z)
        for (const Vec b : basis) result.centres.push_back(splat(side) * (vec(x, y, z) + b));
  result.radii.assign(result.centres.size(), 1.0);
  result.box.hi = splat(cells * side) * vec(1, 1, 1);
  for (bool& p : result.box.periodic) p = periodic;
  return result;
}

inline Lattice simple_cubic(int cells, bool periodic) {
  return fill(cells, 2.0, {vec(0.5, 0.5, 0.5)}, periodic);
}

inline Lattice face_centred_cubic(int cells, bool periodic) {
  return fill(cells, 2.0 * std::sqrt(2.0),
              {vec(0.25, 0.25, 0.25), vec(0.25, 0.75, 0.75), vec(0.75, 0.25, 0.75), vec(0.75, 0.75, 0.25)}, periodic);
}

}  // namespace gabion::dem::lattice
