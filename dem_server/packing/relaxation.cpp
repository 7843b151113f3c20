#include "dem_server/packing/relaxation.hpp"

#include <algorithm>
#include <cmath>

namespace gabion::dem {

namespace {

// FIRE's own figures; the largest step keeps 2/dt above the highest frequency of a grain with a dozen
// contacts of unit stiffness and unit mass.
constexpr int n_min = 5;
constexpr double grow = 1.1, shrink = 0.5, alpha_start = 0.1, alpha_fall = 0.99;
constexpr double dt_start = 0.1, dt_max = 0.4;
constexpr double margin_over_radius = 0.4;

}  // namespace

Relaxation::Relaxation(VecField& centres, std::span<const double> radii, const Domain& domain)
    : centres_(centres), radii_(radii), domain_(domain) {
  for (const double r : radii) mean_radius_ += r;
  mean_radius_ /= static_cast<double>(radii.size());
  margin_ = margin_over_radius * mean_radius_;
  inverse_mass_.reserve(radii.size());
  for (const double r : radii) inverse_mass_.push_back(1.0 / std::max(1.0, r * r / (mean_radius_ * mean_radius_)));
}

void Relaxation::wrap() {
  for (Vec& x : centres_)
    for (int a = 0; a < 3; ++a) {
      const double period = domain_.period(a);
      if (domain_.periodic[a]) x[a] -= period * std::floor((x[a] - domain_.lo[a]) / period);
    }
}

void Relaxation::search(double scale) {
  wrap();
  std::vector<double> scaled(radii_.begin(), radii_.end());
  for (double& r : scaled) r *= scale;
  neighbours_.clear();
  for (const Pair& pair : find_pairs(centres_, scaled, margin_, domain_))
    neighbours_.push_back({pair.i, pair.j, radii_[pair.i] + radii_[pair.j], domain_.offset(pair.image)});
  searched_ = centres_;
  searched_scale_ = scale;
}

double Relaxation::drifted() const {
  double largest = 0.0;
  for (std::size_t i = 0; i < centres_.size(); ++i) {
    const Vec d = centres_[i] - searched_[i];
    largest = std::max(largest, dot(d, d));
  }
  return std::sqrt(largest);
}

void Relaxation::evaluate_forces(double scale, RelaxationOutcome& outcome) {
  std::fill(force_.begin(), force_.end(), Vec{});
  double overlaps = 0.0, squares = 0.0, largest = 0.0;
  std::size_t touching = 0;
  for (const Neighbour& pair : neighbours_) {
    const Vec d = centres_[pair.j] + pair.shift - centres_[pair.i];
    const double distance2 = dot(d, d), reach = scale * pair.reach;
    if (distance2 >= reach * reach) continue;
    const double distance = std::sqrt(distance2), overlap = reach - distance;
    const Vec f = splat(distance > 0.0 ? overlap / distance : 0.0) * d;
    force_[pair.i] -= f;
    force_[pair.j] += f;
    overlaps += overlap;
    squares += overlap * overlap;
    largest = std::max(largest, overlap);
    ++touching;
  }
  support(scale);
  double unbalanced = 0.0;
  for (const Vec& f : force_) unbalanced += dot(f, f);
  const double pairs = static_cast<double>(std::max<std::size_t>(touching, 1));
  outcome.touching = touching;
  outcome.mean_overlap = overlaps / pairs / mean_radius_;
  outcome.max_overlap = largest / mean_radius_;
  outcome.unbalanced =
      squares > 0.0 ? std::sqrt(unbalanced / static_cast<double>(force_.size()) / (squares / pairs)) : 0.0;
}

void Relaxation::support(double scale) {
  for (int a = 0; a < 3; ++a) {
    if (domain_.periodic[a]) continue;
    for (std::size_t i = 0; i < centres_.size(); ++i) {
      const double low = domain_.lo[a] + scale * radii_[i], high = domain_.hi[a] - scale * radii_[i];
      if ((centres_[i][a] <= low && force_[i][a] < 0.0) || (centres_[i][a] >= high && force_[i][a] > 0.0))
        force_[i][a] = 0.0;
    }
  }
}

void Relaxation::advance(double dt, double scale) {
  for (std::size_t i = 0; i < centres_.size(); ++i) {
    velocity_[i] += splat(dt * inverse_mass_[i]) * force_[i];
    centres_[i] += splat(dt) * velocity_[i];
  }
  for (int a = 0; a < 3; ++a) {
    if (domain_.periodic[a]) continue;
    for (std::size_t i = 0; i < centres_.size(); ++i) {
      const double low = domain_.lo[a] + scale * radii_[i], high = domain_.hi[a] - scale * radii_[i];
      const double inside = std::min(std::max(centres_[i][a], low), high);
      if (inside == centres_[i][a]) continue;
      centres_[i][a] = inside;
      velocity_[i][a] = 0.0;
    }
  }
}

RelaxationOutcome Relaxation::run(double scale, const RelaxationLimits& limits) {
  velocity_.assign(centres_.size(), Vec{});
  force_.assign(centres_.size(), Vec{});
  double dt = dt_start, alpha = alpha_start;
  int uphill_free = 0;
  RelaxationOutcome outcome;
  advance(0.0, scale);  // puts grains that are too near to a face onto it
  search(scale);
  for (;; ++outcome.steps) {
    evaluate_forces(scale, outcome);
    if (outcome.mean_overlap < limits.overlap || outcome.unbalanced < limits.unbalanced ||
        outcome.steps >= limits.steps) {
      wrap();
      return outcome;
    }
    double power = 0.0, speed2 = 0.0, force2 = 0.0;
    for (std::size_t i = 0; i < centres_.size(); ++i) {
      power += dot(force_[i], velocity_[i]);
      speed2 += dot(velocity_[i], velocity_[i]);
      force2 += dot(force_[i], force_[i]);
    }
    if (power > 0.0) {
      const double turn = force2 > 0.0 ? alpha * std::sqrt(speed2 / force2) : 0.0;
      for (std::size_t i = 0; i < centres_.size(); ++i)
        velocity_[i] = splat(1.0 - alpha) * velocity_[i] + splat(turn) * force_[i];
      if (++uphill_free > n_min) {
        dt = std::min(dt * grow, dt_max);
        alpha *= alpha_fall;
      }
    } else {
      std::fill(velocity_.begin(), velocity_.end(), Vec{});
      dt *= shrink;
      alpha = alpha_start;
      uphill_free = 0;
    }
    advance(dt, scale);
    if (2.0 * drifted() > margin_) search(scale);
  }
}

}  // namespace gabion::dem
