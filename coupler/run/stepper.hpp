#pragma once
// The coupled loop: both engines at once, tied in every step.

#include <chrono>
#include <optional>

#include "coupler/run/engine_link.hpp"
#include "coupler/run/interface_tie.hpp"

namespace gabion::coupler {

/// Where the wall time of coupled steps goes, s.
struct StepTimes {
  double waiting_dem = 0.0, waiting_continuum = 0.0, solving = 0.0, total = 0.0;
  std::uint64_t steps = 0;
  std::uint64_t bytes = 0;  ///< on the wire, both engines, both ways
};

struct Advance {
  double ledger_age = 0.0;  ///< steps between the time to which the ledgers belong and the end
  std::optional<protocol::RunDone> dem, continuum;
};

class Stepper {
 public:
  /// Any of the links may be null, and the tie with them.
  Stepper(EngineLink* dem, EngineLink* continuum, InterfaceTie* tie) : dem_(dem), continuum_(continuum), tie_(tie) {}

  /// Takes steps of dt and returns what the engines report. The clock moves on. measure: the ledgers are those of the
  /// step so many before the end; 0: none.
  Advance advance(std::uint64_t steps, double dt, double damping, std::uint64_t measure);

  /// Sets the clock of a run that goes on.
  void resume(std::uint64_t step, double time) {
    step_ = step;
    time_ = time;
  }
  std::uint64_t step() const { return step_; }
  double time() const { return time_; }
  const StepTimes& times() const { return times_; }

 private:
  void tie_one_step();
  void check_gap(std::span<const double> gap, const EngineLink& link) const;

  EngineLink* dem_;
  EngineLink* continuum_;
  InterfaceTie* tie_;
  std::uint64_t step_ = 0;
  double time_ = 0.0;
  StepTimes times_;
};

}  // namespace gabion::coupler
