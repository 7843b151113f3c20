#pragma once
// The energy balance of a run, from the ledgers of the engines.

#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "protocol/messages.hpp"

namespace gabion::coupler {

/// balance = stored + lost - work; it must stay what it was at the first measurement. Entries that an engine's
/// ledger names loads, constraints and multipliers are work done on it; kinetic, rotational, elastic and gravity
/// are stored; rate_swing stands aside; all others are lost.
class EnergyBalance {
 public:
  /// Columns of energy.csv after the time, once the first reports are in.
  std::vector<std::string> columns() const { return columns_; }
  /// Adds a measurement and returns the row for energy.csv (without time): both ledgers, the balance, and how far it is
  /// from what it was at the first measurement, or since a body was added.
  std::vector<double> add(const std::optional<protocol::RunDone>& dem, const std::optional<protocol::RunDone>& continuum);

  /// The next measurement has a block more: the energy that it brings is no error. What else a stage changes, its step and
  /// its faces, is in the ledgers.
  void body_added() { new_body_ = true; }

  double error() const { return error_; }                 ///< largest |balance - first| over the largest energy moved
  /// Largest less smallest balance over the largest energy moved.
  double excursion() const { return scale_ > 0.0 ? (high_ - low_) / scale_ : 0.0; }
  /// The same of balance + rate_swing, what waves in elements of several rates hold beyond kinetic + elastic.
  double excursion_with_swing() const { return scale_ > 0.0 ? (high_with_swing_ - low_with_swing_) / scale_ : 0.0; }
  /// As error(), of balance + rate_swing.
  double error_with_swing() const;
  double multiplier_residual() const { return residual_; } ///< |work on grains + work on continuum| over the larger one
  double largest_energy() const { return scale_; }        ///< J
  double dissipated() const { return lost_; }             ///< J
  const std::vector<double>& last() const { return last_; }

  /// For checkpoints.
  nlohmann::json state() const;
  void restore(const nlohmann::json& state);

 private:
  std::vector<std::string> columns_;
  std::vector<double> last_;
  double first_ = 0.0, error_ = 0.0, residual_ = 0.0, scale_ = 0.0, lost_ = 0.0, drift_ = 0.0;
  double previous_ = 0.0;
  double low_ = 0.0, high_ = 0.0;  ///< balance less first
  double first_swing_ = 0.0, low_with_swing_ = 0.0, high_with_swing_ = 0.0;
  bool started_ = false, new_body_ = false;
};

}  // namespace gabion::coupler
