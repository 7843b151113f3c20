#pragma once
// Where grains stand, where the continuum stands, and where both do.
//
//   outer box   the zone's faces that lie strictly inside the ground; infinite where the zone ends at the ground
//   inner box   the outer box shrunk by the overlap (bridging); the hole that the continuum leaves
//   overlap     between the two
//
//   w(X)  = clamp(distance to the nearest outer face / L, floor, 1)                     share of the grains
//   q_i   = Q_outer(x_i) (1 - Q_inner(x_i)),  Q = product over faces of clamp(1/2 + t/(2 r_i), 0, 1)
//           t signed distance inward from the face: share of grain i inside the overlap (design: coupling, rows)

#include "coupler/scene/scene.hpp"

namespace gabion::coupler {

using scene::Box;
using scene::Point;

class Zone {
 public:
  Zone() = default;
  /// overlap in m; 0 for edge-to-edge.
  Zone(const Box& ground, const Box& zone, double overlap, double weight_floor);

  bool has_interface() const;
  const Box& outer() const { return outer_; }
  const Box& inner() const { return inner_; }
  double overlap() const { return overlap_; }
  double weight_floor() const { return weight_floor_; }

  double weight(const Point& x) const;
  double overlap_share(const Point& x, double radius) const;

  /// Largest distance beyond an outer face; negative inside.
  double beyond_outer(const Point& x) const { return beyond(outer_, x); }
  double beyond_inner(const Point& x) const { return beyond(inner_, x); }

  /// The outer face (0 to 5, xmin ... zmax) nearest to x from either side, -1 without interface.
  int nearest_outer_face(const Point& x) const;
  double face_position(int face) const { return face % 2 == 0 ? outer_.lo[face / 2] : outer_.hi[face / 2]; }

 private:
  static double beyond(const Box& box, const Point& x);

  Box outer_, inner_;
  double overlap_ = 0.0, weight_floor_ = 0.0;
};

}  // namespace gabion::coupler
