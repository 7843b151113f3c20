#include "dem_server/restitution.hpp"

#include <cmath>
#include <numbers>

namespace gabion::dem {
namespace {

/// Where a rising function of x reaches the wanted value, to round-off.
template <typename Function>
double bisect(Function&& rising, double wanted, double low, double high) {
  for (;;) {
    const double middle = 0.5 * (low + high);
    if (middle <= low || middle >= high) return middle;
    (rising(middle) < wanted ? low : high) = middle;
  }
}

}  // namespace

double damping_ratio(double restitution) {
  const double wanted = -std::log(restitution);
  if (!(wanted > 0.0)) return 0.0;
  constexpr double at_critical = 2.0;
  if (wanted < at_critical) {
    const auto loss = [](double phi) { return (std::numbers::pi - 2.0 * phi) * std::tan(phi); };
    return std::sin(bisect(loss, wanted, 0.0, 0.5 * std::numbers::pi));
  }
  const auto loss = [](double eta) { return eta > 0.0 ? 2.0 * eta / std::tanh(eta) : at_critical; };
  return std::cosh(bisect(loss, wanted, 0.0, wanted));
}

}  // namespace gabion::dem
