#include "dem_server/packing/radii.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "protocol/engine/engine.hpp"

namespace gabion::dem {
namespace {

constexpr double sphere_factor = 4.0 / 3.0 * std::numbers::pi;

[[noreturn]] void refuse(const std::string& message, const std::string& advice) {
  throw engine::RequestError("PACK radius", message, advice);
}

double cubes(const std::vector<double>& radii) {
  double total = 0.0;
  for (const double r : radii) total += r * r * r;
  return total;
}

}  // namespace

RadiusDistribution::RadiusDistribution(const std::string& kind, std::vector<double> parameters)
    : parameters_(std::move(parameters)), sieve_(kind == "sieve") {
  if (!sieve_ && kind != "uniform") refuse("unknown radius kind '" + kind + "'", "use uniform or sieve");
  for (const double p : parameters_)
    if (!std::isfinite(p)) refuse("a parameter is not finite", "give finite numbers");
  if (sieve_) {
    read_sieves();
    return;
  }
  if (parameters_.size() != 2) refuse("uniform needs two radii", "give the smallest and the largest radius");
  smallest_ = parameters_[0];
  largest_ = parameters_[1];
  if (!(smallest_ > 0.0) || largest_ < smallest_)
    refuse("radii " + std::to_string(smallest_) + " to " + std::to_string(largest_) + " m are no interval",
           "give 0 < smallest <= largest");
}

// Mass share dP uniform in r over [a, b] means a number density dP/(b-a) r^-3 / (4/3 pi rho):
//   share by number  N  ~ dP/(b-a) (a^-2 - b^-2)/2,   by number below r: (a^-2 - r^-2)/(a^-2 - b^-2)
//   mean radius by volume = sum dP (a + b)/2
//   mean volume      = total mass/(rho total number) = 4/3 pi / sum N     (shares sum to 1)
void RadiusDistribution::read_sieves() {
  const std::size_t sieves = parameters_.size() / 2;
  if (parameters_.size() % 2 != 0 || sieves < 2) refuse("sieve needs pairs of radius and share", "give at least two");
  for (std::size_t k = 0; k + 1 < sieves; ++k)
    if (!(parameters_[2 * k] > 0.0) || parameters_[2 * k + 2] <= parameters_[2 * k] ||
        parameters_[2 * k + 3] < parameters_[2 * k + 1])
      refuse("pair " + std::to_string(k + 1) + " does not increase", "order the pairs by radius and share");
  if (parameters_[1] != 0.0 || parameters_.back() != 1.0)
    refuse("the shares run from " + std::to_string(parameters_[1]) + " to " + std::to_string(parameters_.back()),
           "let them run from 0 to 1");
  smallest_ = parameters_[0];
  largest_ = parameters_[parameters_.size() - 2];
  cumulative_number_.assign(1, 0.0);
  for (std::size_t k = 0; k + 1 < sieves; ++k) {
    const double a = parameters_[2 * k], b = parameters_[2 * k + 2];
    const double mass = parameters_[2 * k + 3] - parameters_[2 * k + 1];
    sieve_mean_radius_by_volume_ += mass * (a + b) / 2.0;
    cumulative_number_.push_back(cumulative_number_.back() + mass / (b - a) * (1.0 / (a * a) - 1.0 / (b * b)) / 2.0);
  }
  const double total = cumulative_number_.back();
  sieve_mean_volume_ = sphere_factor / total;
  for (double& c : cumulative_number_) c /= total;
}

double RadiusDistribution::sieve_quantile(double u) const {
  const auto above = std::upper_bound(cumulative_number_.begin() + 1, cumulative_number_.end() - 1, u);
  const std::size_t k = static_cast<std::size_t>(above - cumulative_number_.begin()) - 1;
  const double a = parameters_[2 * k], b = parameters_[2 * k + 2];
  const double inside = (u - cumulative_number_[k]) / (cumulative_number_[k + 1] - cumulative_number_[k]);
  const double a2 = 1.0 / (a * a), b2 = 1.0 / (b * b);
  return std::clamp(1.0 / std::sqrt(a2 - std::clamp(inside, 0.0, 1.0) * (a2 - b2)), a, b);
}

double RadiusDistribution::quantile(double u) const {
  return sieve_ ? sieve_quantile(u) : smallest_ + u * (largest_ - smallest_);
}

double RadiusDistribution::mean_volume() const {
  if (sieve_) return sieve_mean_volume_;
  const double a = smallest_, b = largest_;
  return sphere_factor * (a + b) * (a * a + b * b) / 4.0;  // mean of r^3 over [a, b]
}

double RadiusDistribution::mean_radius_by_volume() const {
  if (sieve_) return sieve_mean_radius_by_volume_;
  const double a = smallest_, b = largest_;  // mean of r^4 over mean of r^3, both over [a, b]
  const double fifth = b * b * b * b + b * b * b * a + b * b * a * a + b * a * a * a + a * a * a * a;
  const double fourth = (a + b) * (a * a + b * b);
  return 4.0 / 5.0 * fifth / fourth;
}

std::vector<double> draw_radii(const RadiusDistribution& distribution, double volume, Random& random) {
  const double wanted = volume / sphere_factor;
  const double number = std::max(1.0, std::round(volume / distribution.mean_volume()));
  std::vector<double> radii(static_cast<std::size_t>(number));
  for (std::size_t k = 0; k < radii.size(); ++k)
    radii[k] = distribution.quantile((static_cast<double>(k) + random.uniform()) / number);
  random.shuffle(radii);

  const double lowest = std::pow(distribution.smallest(), 3), highest = std::pow(distribution.largest(), 3);
  double missing = wanted - cubes(radii);
  for (double& r : radii) {
    const double old_cube = r * r * r;
    const double new_cube = std::clamp(old_cube + missing, lowest, highest);
    missing -= new_cube - old_cube;
    r = std::clamp(std::cbrt(new_cube), distribution.smallest(), distribution.largest());
    if (missing == 0.0) break;
  }
  const double factor = std::cbrt(wanted / cubes(radii));
  if (std::abs(factor - 1.0) > 1e-12)
    for (double& r : radii) r *= factor;
  return radii;
}

}  // namespace gabion::dem
