#include "protocol/session/heartbeat.hpp"

namespace gabion::protocol {

Heartbeats::Heartbeats(Connection& connection, std::function<Heartbeat()> present, Duration period)
    : connection_(connection), present_(std::move(present)), period_(period), thread_([this] { watch(); }) {}

Heartbeats::~Heartbeats() {
  {
    const std::lock_guard lock(mutex_);
    ending_ = true;
  }
  changed_.notify_one();
  thread_.join();
}

void Heartbeats::work_begins() {
  {
    const std::lock_guard lock(mutex_);
    working_ = true;
    next_ = Clock::now() + period_;
  }
  changed_.notify_one();
}

void Heartbeats::work_ends() {
  // The thread sends with the mutex held, so none is under way once this returns.
  const std::lock_guard lock(mutex_);
  working_ = false;
}

void Heartbeats::watch() {
  std::unique_lock lock(mutex_);
  while (!ending_) {
    if (!working_ || peer_is_gone_) {
      changed_.wait(lock);
      continue;
    }
    if (Clock::now() < next_) {
      changed_.wait_until(lock, next_);
      continue;
    }
    next_ += period_;
    const Heartbeat message = present_();
    try {
      connection_.send(message, message.step);
    } catch (const WireError&) {
      peer_is_gone_ = true;
    }
  }
}

}  // namespace gabion::protocol
