#pragma once
// Tells the other side that work goes on, from a thread of its own: an engine while it works on a request, the coupler
// while it works between two.

#include <atomic>
#include <condition_variable>
#include <functional>
#include <mutex>
#include <thread>

#include "protocol/wire/connection.hpp"

namespace gabion::protocol {

/// Sends HEARTBEAT every period while work has lasted longer than one.
class Heartbeats {
 public:
  /// Takes what to say from `present`, which the thread calls while the work goes on.
  Heartbeats(Connection& connection, std::function<Heartbeat()> present, Duration period);
  ~Heartbeats();

  void work_begins();
  /// After this no heartbeat is sent until work begins again.
  void work_ends();
  /// True when a heartbeat could not be sent; nobody will take the result of the work.
  bool peer_is_gone() const { return peer_is_gone_; }

 private:
  void watch();

  Connection& connection_;
  const std::function<Heartbeat()> present_;
  const Duration period_;
  std::mutex mutex_;
  std::condition_variable changed_;
  bool working_ = false, ending_ = false;
  Clock::time_point next_;
  std::atomic<bool> peer_is_gone_{false};
  std::thread thread_;  ///< last: it uses the others
};

}  // namespace gabion::protocol
