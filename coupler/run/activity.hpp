#pragma once
// What the coupler is doing, for the heartbeats that another thread sends.

#include <atomic>

namespace gabion::coupler {

class Activity {
 public:
  /// phase: a literal, a few words.
  void is(const char* phase) { phase_ = phase; }
  const char* phase() const { return phase_; }

 private:
  std::atomic<const char*> phase_{"starting"};
};

}  // namespace gabion::coupler
