#include "coupler/scene/origin.hpp"

#include <algorithm>
#include <cmath>

namespace gabion::scene {

namespace {

constexpr double sides_to_origin = 100.0;  // largest step between origins, in sides of the ground

/// A decimal grid: what was written with few digits becomes that number again.
double steps_per_metre(double origin) {
  constexpr double safety = 4.0;
  const double spacing = std::nextafter(std::fabs(origin), infinity) - std::fabs(origin);
  return std::pow(10.0, std::floor(-std::log10(safety * spacing)));
}

Point local(const Point& x, const Point& origin) {
  return {local_coordinate(x[0], origin[0]), local_coordinate(x[1], origin[1]), local_coordinate(x[2], origin[2])};
}

Box local(const Box& box, const Point& origin) { return {local(box.lo, origin), local(box.hi, origin)}; }

}  // namespace

double local_coordinate(double x, double origin) {
  if (origin == 0.0) return x;
  const double per_metre = steps_per_metre(origin);
  return std::round((x - origin) * per_metre) / per_metre;
}

double coordinate_step(double origin) { return origin == 0.0 ? 0.0 : 1.0 / steps_per_metre(origin); }

void count_from_origin(Scene& scene) {
  const Box ground = scene.ground.box;
  double side = 0.0;
  for (int axis = 0; axis < 3; ++axis) side = std::max(side, ground.hi[axis] - ground.lo[axis]);
  if (!(side > 0.0)) return;  // refused later
  const double step = std::pow(10.0, std::floor(std::log10(sides_to_origin * side)));
  for (int axis = 0; axis < 3; ++axis)
    scene.origin[axis] = step * std::round(0.5 * (ground.lo[axis] + ground.hi[axis]) / step);
  const Point origin = scene.origin;
  scene.ground.box = local(ground, origin);
  for (Fill& fill : scene.fills) fill.box = local(fill.box, origin);
  if (scene.grains.zone) scene.grains.zone = local(*scene.grains.zone, origin);
  if (scene.block) {
    const double height = scene.block->position[2];
    scene.block->position = local(scene.block->position, origin);
    if (scene.block->touching) scene.block->position[2] = height;
  }
  if (scene.wave) scene.wave->centre = local_coordinate(scene.wave->centre, origin[scene.wave->axis]);
  for (Probe& probe : scene.probes) probe.at = local(probe.at, origin);
}

}  // namespace gabion::scene
