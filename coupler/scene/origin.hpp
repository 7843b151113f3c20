#pragma once
// Scenes far from the origin. Numbers of 1e6 m are 1e-10 m apart: planes of a lattice fall on either side of a face,
// and a random packing becomes another one. Such a scene is computed about an origin of its own.

#include "coupler/scene/scene.hpp"

namespace gabion::scene {

/// Sets scene.origin to round numbers near the ground, 0 for a ground near the origin, and counts every coordinate of
/// the scene from there. Along each axis the origin is a multiple of the power of ten between 10 and 100 times the ground's
/// largest side, so that a scene that is moved by such multiples gives the same bits.
void count_from_origin(Scene& scene);

/// Step between the numbers that local_coordinate gives for this origin, m; 0 for the origin itself.
double coordinate_step(double origin);

/// x less the origin, both in m, without the digits that x cannot have so far away.
double local_coordinate(double x, double origin);

}  // namespace gabion::scene
