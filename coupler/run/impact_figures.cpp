#include "coupler/run/impact_figures.hpp"

#include <algorithm>
#include <cmath>

namespace gabion::coupler {

namespace {

constexpr double force_window = 4e-3;   // s
constexpr double early = 60e-3;         // s after release: the braking is over, the recoil of the ground not begun
constexpr double creep_share = 0.05;    // of the speed at release
constexpr double rounding = 1e-9;

/// Value between rows, the first and last one beyond them.
double between(const std::vector<double>& x, const std::vector<double>& y, double at) {
  const auto after = std::lower_bound(x.begin(), x.end(), at);
  if (after == x.begin()) return y.front();
  if (after == x.end()) return y.back();
  const std::size_t k = static_cast<std::size_t>(after - x.begin());
  const double share = (at - x[k - 1]) / (x[k] - x[k - 1]);
  return y[k - 1] + share * (y[k] - y[k - 1]);
}

}  // namespace

void ImpactFigures::add(double time, double penetration, double speed, double mean_force, double largest_force) {
  time_.push_back(time);
  penetration_.push_back(penetration);
  speed_.push_back(speed);
  mean_force_.push_back(mean_force);
  largest_force_ = std::max(largest_force_, largest_force);
}

nlohmann::json ImpactFigures::figures(double release, double mass, double speed, double energy, double gravity) const {
  std::vector<double> edge{release}, impulse{0.0};
  for (std::size_t k = 0; k < time_.size(); ++k) {
    impulse.push_back(impulse.back() + mean_force_[k] * (time_[k] - edge.back()));
    edge.push_back(time_[k]);
  }
  double largest_mean = 0.0;
  for (const double t : edge) {
    const double from = std::max(t - 0.5 * force_window, edge.front()), to = std::min(t + 0.5 * force_window, edge.back());
    if (to - from < 0.5 * force_window) continue;
    largest_mean = std::max(largest_mean, (between(edge, impulse, to) - between(edge, impulse, from)) / (to - from));
  }
  const double last = penetration_.back();
  double stop = release;
  for (std::size_t k = 0; k < time_.size(); ++k)
    if (speed_[k] > creep_share * speed) stop = time_[k];

  nlohmann::json figures{{"largest_force", largest_force_}, {"largest_force_4ms", largest_mean}, {"penetration_end", last},
                         {"penetration_largest", *std::max_element(penetration_.begin(), penetration_.end())},
                         {"speed_end", speed_.back()}, {"impulse_end", impulse.back()}, {"energy_at_release", energy},
                         {"S", largest_mean * last / (energy + mass * gravity * last)}};
  if (stop < time_.back()) {
    figures["time_to_stop"] = stop - release;
    figures["impulse_to_stop"] = between(edge, impulse, stop);
  }
  const auto slow = std::find_if(speed_.begin(), speed_.end(), [&](double v) { return v <= creep_share * speed; });
  if (slow != speed_.end()) {
    const auto k = static_cast<std::size_t>(slow - speed_.begin());
    figures["time_to_first_stop"] = time_[k] - release;
    figures["penetration_first_stop"] = penetration_[k];
  }
  if (time_.back() >= release + early * (1.0 - rounding)) {
    figures["penetration_60ms"] = between(time_, penetration_, release + early);
    figures["impulse_60ms"] = between(edge, impulse, release + early);
  }
  return figures;
}

nlohmann::json ImpactFigures::memory() const {
  return {{"time", time_}, {"penetration", penetration_}, {"speed", speed_}, {"mean_force", mean_force_}, {"largest_force", largest_force_}};
}

void ImpactFigures::remember(const nlohmann::json& memory) {
  memory.at("time").get_to(time_);
  memory.at("penetration").get_to(penetration_);
  memory.at("speed").get_to(speed_);
  memory.at("mean_force").get_to(mean_force_);
  memory.at("largest_force").get_to(largest_force_);
}

}  // namespace gabion::coupler
