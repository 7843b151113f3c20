#include "coupler/run/rates.hpp"

#include <algorithm>

#include "protocol/messages.hpp"

namespace gabion::coupler {

namespace {

/// The largest rate that `auto` looks at: more saves nothing that can be measured.
constexpr std::uint64_t most_automatic = 32;
/// Share of an element's own limit that its step may have.
constexpr double safe_share = 0.9;

}  // namespace

Rates::Rates(const std::optional<scene::Rates>& wanted, const HexMesh& mesh, EngineLink* continuum)
    : wanted_(mesh.level.empty() ? std::nullopt : wanted), mesh_(mesh), continuum_(continuum) {
  if (!wanted_) return;
  node_level_.assign(mesh.nodes.size(), 255);
  for (std::size_t e = 0; e < mesh.elements.size(); ++e)
    for (const std::int32_t n : mesh.elements[e]) {
      auto& level = node_level_[static_cast<std::size_t>(n)];
      level = std::min(level, mesh.level[e]);
    }
}

std::uint64_t Rates::rate(std::size_t element) const {
  const std::uint64_t level = mesh_.level[element];
  if (!wanted_->nested) return level == 0 ? 1 : largest_;
  return std::min<std::uint64_t>(largest_, std::uint64_t{1} << level);
}

double Rates::node_rate(std::size_t node) const {
  if (largest_ == 1) return 1.0;
  const std::uint64_t level = node_level_[node];
  const std::uint64_t own = wanted_->nested ? std::uint64_t{1} << level : level == 0 ? 1 : largest_;
  return static_cast<double>(std::min(largest_, own));
}

void Rates::plan(double dt) {
  if (!wanted_) return;
  std::uint64_t most = fixed() ? static_cast<std::uint64_t>(wanted_->largest) : most_automatic;
  const std::uint8_t farthest = *std::max_element(mesh_.level.begin(), mesh_.level.end());
  if (wanted_->nested || farthest == 0) most = std::min(most, std::uint64_t{1} << farthest);
  period_ = fixed() ? most : fit(dt, most);
  cut(1);
}

std::uint64_t Rates::fit(double dt) {
  return fit(dt, period_);
}

std::uint64_t Rates::fit(double dt, std::uint64_t most) {
  for (std::uint64_t largest = most; largest > 1; largest /= 2) {
    cut(largest);
    if (dt <= safe_share * continuum_->ask<protocol::Ready>(protocol::StableStep{}).stable_step) return largest;
  }
  cut(1);
  return 1;
}

void Rates::cut(std::uint64_t largest) {
  if (largest == largest_) return;
  largest_ = largest;
  protocol::Rates rates;
  std::vector<std::uint8_t> values;
  if (largest > 1)
    for (std::size_t e = 0; e < mesh_.elements.size(); ++e) values.push_back(static_cast<std::uint8_t>(rate(e)));
  rates.rate = values;
  continuum_->tell(rates);
}

void Rates::resume(std::uint64_t period, std::uint64_t largest) {
  period_ = period;
  cut(largest);
}

std::uint64_t Rates::element_steps(std::uint64_t steps) const {
  if (largest_ == 1) return steps * mesh_.elements.size();
  std::uint64_t a_period = 0;
  for (std::size_t e = 0; e < mesh_.elements.size(); ++e) a_period += largest_ / rate(e);
  return steps / largest_ * a_period;
}

std::vector<std::size_t> Rates::elements() const {
  std::vector<std::size_t> counts;
  for (std::uint64_t r = 1; r <= largest_; r *= 2) {
    std::size_t count = largest_ == 1 ? mesh_.elements.size() : 0;
    for (std::size_t e = 0; largest_ > 1 && e < mesh_.elements.size(); ++e) count += rate(e) == r;
    counts.push_back(count);
  }
  return counts;
}

}  // namespace gabion::coupler
