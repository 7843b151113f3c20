#include "coupler/run/energy.hpp"

#include <algorithm>
#include <cmath>
#include <set>

namespace gabion::coupler {

namespace {

constexpr const char* swing_name = "rate_swing";
const std::set<std::string> works{"loads", "constraints", "multipliers", "walls"};
const std::set<std::string> stores{"kinetic", "rotational", "elastic", "gravity"};

}  // namespace

std::vector<double> EnergyBalance::add(const std::optional<protocol::RunDone>& dem,
                                       const std::optional<protocol::RunDone>& continuum) {
  double balance = 0.0, moved = 0.0, lost = 0.0, swing = 0.0;
  double tie_work[2] = {0.0, 0.0};
  std::vector<double> row;
  columns_.clear();
  int side = 0;
  for (const auto* report : {&dem, &continuum}) {
    if (*report)
      for (std::size_t i = 0; i < (*report)->ledger_names.size(); ++i) {
        const std::string& name = (*report)->ledger_names[i];
        const double value = (*report)->ledger[i];
        columns_.push_back((side == 0 ? "grains " : "continuum ") + name + " [J]");
        row.push_back(value);
        if (name == swing_name) {
          swing += value;
          continue;
        }
        const bool work = works.contains(name);
        balance += work ? -value : value;
        if (name == "multipliers") tie_work[side] = value;
        if (name == "kinetic" || name == "rotational" || name == "elastic") moved += std::fabs(value);
        if (name == "loads" || name == "constraints") moved = std::max(moved, std::fabs(value));
        if (!work && !stores.contains(name)) lost += value;
      }
    ++side;
  }
  if (!started_) {
    first_ = balance;
    first_swing_ = swing;
  }
  if (started_ && new_body_) first_ += balance - previous_;
  started_ = true;
  new_body_ = false;
  previous_ = balance;
  lost_ = lost;
  scale_ = std::max({scale_, moved, lost});
  drift_ = std::isfinite(balance) ? std::max(drift_, std::fabs(balance - first_)) : INFINITY;
  low_ = std::min(low_, balance - first_);
  high_ = std::max(high_, balance - first_);
  const double with_swing = balance - first_ + swing - first_swing_;
  low_with_swing_ = std::min(low_with_swing_, with_swing);
  high_with_swing_ = std::max(high_with_swing_, with_swing);
  error_ = scale_ > 0.0 ? drift_ / scale_ : 0.0;
  const double larger = std::max(std::fabs(tie_work[0]), std::fabs(tie_work[1]));
  if (larger > 0.0) residual_ = std::fabs(tie_work[0] + tie_work[1]) / larger;
  columns_.insert(columns_.end(), {"balance [J]", "balance error [J]"});
  row.insert(row.end(), {balance, balance - first_});
  last_ = row;
  return row;
}

double EnergyBalance::error_with_swing() const {
  if (!std::isfinite(error_) || scale_ == 0.0) return error_;
  return std::max(high_with_swing_, -low_with_swing_) / scale_;
}

nlohmann::json EnergyBalance::state() const {
  return {{"first", first_}, {"error", error_}, {"residual", residual_}, {"scale", scale_}, {"lost", lost_}, {"drift", drift_},
          {"previous", previous_}, {"started", started_}, {"new_body", new_body_}, {"low", low_}, {"high", high_},
          {"first_swing", first_swing_}, {"low_with_swing", low_with_swing_}, {"high_with_swing", high_with_swing_}};
}

void EnergyBalance::restore(const nlohmann::json& state) {
  first_ = state.at("first");
  error_ = state.at("error");
  residual_ = state.at("residual");
  scale_ = state.at("scale");
  lost_ = state.at("lost");
  drift_ = state.at("drift");
  previous_ = state.at("previous");
  started_ = state.at("started");
  new_body_ = state.at("new_body");
  low_ = state.at("low");
  high_ = state.at("high");
  first_swing_ = state.at("first_swing");
  low_with_swing_ = state.at("low_with_swing");
  high_with_swing_ = state.at("high_with_swing");
}

}  // namespace gabion::coupler
