#include "dem_server/laboratory/servo.hpp"

#include <algorithm>

namespace gabion::dem {
namespace {

/// Times of the servo in steps. The proportional part answers within a grain's own oscillation; the integral part is
/// well damped as long as the sample keeps its stiffness (damping ratio 1.9) and still damped, 0.3, when it has 2 % left.
constexpr double proportional_steps = 8.0, integral_steps = 120.0;
/// Contacts may go until hardly any is left: the servo must not answer without bound.
constexpr double least_share = 0.05;

}  // namespace

Servo::Servo(Vec stiffness, double step, double largest_rate)
    : stiffness_(stiffness),
      proportional_(proportional_steps * step),
      integral_(integral_steps * step),
      largest_rate_(largest_rate) {}

void Servo::set_stiffness(Vec stiffness) {
  for (int axis = 0; axis < 3; ++axis) stiffness_[axis] = std::max(stiffness[axis], least_share * stiffness_[axis]);
}

Vec Servo::rate(Vec pressure, double wanted, double step) {
  Vec rate{};
  for (int axis = 0; axis < 3; ++axis) {
    const double missing = (pressure[axis] - wanted) / stiffness_[axis];
    const double sum = sum_[axis] + missing * step / integral_;
    const double asked = (missing + sum) / proportional_;
    rate[axis] = std::clamp(asked, -largest_rate_, largest_rate_);
    if (rate[axis] == asked) sum_[axis] = sum;  // no winding up beyond the bound
  }
  return rate;
}

}  // namespace gabion::dem
