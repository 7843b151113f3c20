#include "coupler/ground/zone.hpp"

#include <algorithm>
#include <cmath>

namespace gabion::coupler {

using scene::infinity;

namespace {

/// Share of a grain inside a box, one plane at a time.
double share_inside(const Box& box, const Point& x, double radius) {
  double share = 1.0;
  for (int axis = 0; axis < 3; ++axis) {
    if (std::isfinite(box.lo[axis])) share *= std::clamp(0.5 + (x[axis] - box.lo[axis]) / (2 * radius), 0.0, 1.0);
    if (std::isfinite(box.hi[axis])) share *= std::clamp(0.5 + (box.hi[axis] - x[axis]) / (2 * radius), 0.0, 1.0);
  }
  return share;
}

}  // namespace

Zone::Zone(const Box& ground, const Box& zone, double overlap, double weight_floor)
    : overlap_(overlap), weight_floor_(weight_floor) {
  for (int axis = 0; axis < 3; ++axis) {
    const double tolerance = 1e-9 * (ground.hi[axis] - ground.lo[axis]);
    const bool low = zone.lo[axis] > ground.lo[axis] + tolerance;
    const bool high = zone.hi[axis] < ground.hi[axis] - tolerance;
    outer_.lo[axis] = low ? zone.lo[axis] : -infinity;
    outer_.hi[axis] = high ? zone.hi[axis] : infinity;
    inner_.lo[axis] = low ? zone.lo[axis] + overlap : -infinity;
    inner_.hi[axis] = high ? zone.hi[axis] - overlap : infinity;
  }
}

bool Zone::has_interface() const {
  for (int axis = 0; axis < 3; ++axis)
    if (std::isfinite(outer_.lo[axis]) || std::isfinite(outer_.hi[axis])) return true;
  return false;
}

double Zone::weight(const Point& x) const {
  if (overlap_ <= 0.0) return 1.0;
  return std::clamp(-beyond(outer_, x) / overlap_, weight_floor_, 1.0);
}

double Zone::overlap_share(const Point& x, double radius) const {
  return share_inside(outer_, x, radius) * (1.0 - (has_interface() ? share_inside(inner_, x, radius) : 1.0));
}

double Zone::beyond(const Box& box, const Point& x) {
  double largest = -infinity;
  for (int axis = 0; axis < 3; ++axis) largest = std::max({largest, box.lo[axis] - x[axis], x[axis] - box.hi[axis]});
  return largest;
}

int Zone::nearest_outer_face(const Point& x) const {
  int nearest = -1;
  double largest = -infinity;
  for (int face = 0; face < 6; ++face) {
    const double position = face_position(face);
    if (!std::isfinite(position)) continue;
    const double outward = face % 2 == 0 ? position - x[face / 2] : x[face / 2] - position;
    if (outward > largest) {
      largest = outward;
      nearest = face;
    }
  }
  return nearest;
}

}  // namespace gabion::coupler
