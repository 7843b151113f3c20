#pragma once
// A convex polyhedron: its mass properties, and the point of it that is nearest to a given one.

#include <cstdint>
#include <vector>

#include "dem_server/neighbours.hpp"

namespace gabion::dem {

struct Polyhedron {
  std::vector<Vec> vertices;            ///< m
  std::vector<std::vector<int>> faces;  ///< corners anticlockwise seen from outside
  std::vector<Vec> normals;             ///< outward, unit
  double volume = 0.0;                  ///< m3
  Vec centroid{};                       ///< m
  double inertia[3][3] = {};            ///< about the centroid for unit mass, m2

  /// Throws std::invalid_argument when it is not closed, not convex, turned inside out or flat.
  Polyhedron(std::vector<Vec> vertices, const std::vector<std::int32_t>& face_ptr,
             const std::vector<std::int32_t>& face_vertices);
  Polyhedron() = default;

  /// The polyhedron moved by -origin and turned by the transposed rotation (columns are the new axes).
  void move_to_axes(Vec origin, const Vec axes[3]);

  double radius() const;  ///< largest distance of a corner from the origin, m
};

struct NearestPoint {
  double distance;  ///< m, negative inside
  Vec outward;      ///< unit vector from the surface to the point (inside: the nearest face's normal)
};

/// Exact for points outside; inside, the face of least depth.
NearestPoint nearest_point(const Polyhedron& body, Vec x);

}  // namespace gabion::dem
