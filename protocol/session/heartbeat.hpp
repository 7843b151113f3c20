#pragma once
// Tells the client that a long request is being worked on, from a thread of its own.

#include <condition_variable>
#include <mutex>
#include <thread>

#include "protocol/engine/engine.hpp"
#include "protocol/wire/connection.hpp"

namespace gabion::protocol {

/// Sends HEARTBEAT every period while work has lasted longer than one.
class Heartbeats {
 public:
  Heartbeats(Connection& connection, const engine::Engine& engine, Duration period);
  ~Heartbeats();

  void work_begins();
  /// After this no heartbeat is sent until work begins again.
  void work_ends();
  /// True when a heartbeat could not be sent; nobody will take the result of the work.
  bool client_is_gone() const { return client_is_gone_; }

 private:
  void watch();

  Connection& connection_;
  const engine::Engine& engine_;
  const Duration period_;
  std::mutex mutex_;
  std::condition_variable changed_;
  bool working_ = false, ending_ = false;
  Clock::time_point next_;
  std::atomic<bool> client_is_gone_{false};
  std::thread thread_;  ///< last: it uses the others
};

}  // namespace gabion::protocol
