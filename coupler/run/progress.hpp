#pragma once
// The line the user watches: stage, simulated time, steps per second, time left, energy error.

#include <chrono>
#include <cstdint>
#include <string>

namespace gabion::coupler {

class Progress {
 public:
  Progress();
  /// part: share of the stage that is done, below 0 when it is not known. Writes at most twice a second on a
  /// terminal, every ten seconds into a file.
  void show(const std::string& stage, std::uint64_t step, double time, double part, double unbalanced, double energy_error);
  void end_line();
  double steps_per_second() const { return rate_; }

 private:
  using Clock = std::chrono::steady_clock;
  bool terminal_;
  bool dirty_ = false;
  Clock::time_point shown_, rated_, stage_begin_;
  std::string stage_;
  std::uint64_t rated_step_ = 0;
  double rate_ = 0.0, first_part_ = 0.0;
};

}  // namespace gabion::coupler
