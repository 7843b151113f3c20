#pragma once
// Small geometry of a scene, shared by its checks.

#include <array>
#include <string>

#include "coupler/scene/scene.hpp"

namespace gabion::scene {

/// Names of the faces, in their order.
extern const std::array<std::string, 6> face_names;

/// Face 0 to 5 lies in direction face / 2; odd ones at the upper end.
inline double& face_coordinate(Box& box, int face) {
  return face % 2 == 0 ? box.lo[face / 2] : box.hi[face / 2];
}
inline double face_coordinate(const Box& box, int face) {
  return face % 2 == 0 ? box.lo[face / 2] : box.hi[face / 2];
}

/// Coordinates nearer than this are the same, m.
double tolerance(const Box& box);

bool contains(const Box& box, const Point& point, double slack);

/// Whether a face of the zone lies strictly inside the ground.
bool is_interface(const Scene& scene, int face);

/// Edge of the cubic cell of a lattice of spheres, over the radius.
double cell_over_radius(const std::string& packing);

/// Distance from the block's centre to its lowest point, m.
double depth_below_centre(const Block& block);

/// End of a history's changes, s.
double end_of(const History& history);

}  // namespace gabion::scene
