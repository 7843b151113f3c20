#pragma once
// Shapes and helpers that the tests of clumps share.

#include "fixture.hpp"

namespace gabion::dem::testing {

inline ClumpRequest clumps_of(std::int32_t size, double gap = 0.02) {
  return {{size}, gap, {}};
}

/// Four touching spheres of different sizes, principal inertias all different.
inline Spheres odd_clump() {
  const double r[4] = {0.5, 0.4, 0.3, 0.35};
  Spheres s;
  s.x = {vec(0, 0, 0), vec(r[0] + r[1], 0, 0)};
  s.x.push_back(vec(0, r[0] + r[2], 0));
  s.x.push_back(s.x[1] + vec(0.6, 0, 0.8) * splat(r[1] + r[3]));
  s.r.assign(r, r + 4);
  return s;
}

inline Wall wall(Vec point, Vec normal, double friction) {
  Wall w;
  w.point = point;
  w.normal = normal;
  w.friction = friction;
  return w;
}

inline VecField rigid_velocity(const Spheres& s, Vec velocity, Vec spin, Vec about) {
  VecField v;
  for (const Vec x : s.x) v.push_back(velocity + cross(spin, x - about));
  return v;
}

}  // namespace gabion::dem::testing
