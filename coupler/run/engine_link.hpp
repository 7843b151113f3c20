#pragma once
// One engine, as the coupler talks to it: requests with their replies, and the rows of a coupled step. Between two
// requests a thread tells the engine once a second that the coupler is still there, and what it does.

#include <chrono>
#include <span>
#include <string>
#include <vector>

#include "coupler/run/activity.hpp"
#include "protocol/messages.hpp"
#include "protocol/session/heartbeat.hpp"
#include "protocol/wire/connection.hpp"

namespace gabion::coupler {

class EngineLink {
 public:
  /// Connects and greets. role: dem or continuum. Throws the protocol's exceptions, which name the engine, and
  /// protocol::AddressError when it plays another role. activity outlives the link.
  /// patience: how long an engine may be silent in a step or a request; starts anew with every heartbeat.
  EngineLink(const std::string& role, const protocol::Address& address, const std::string& token,
             const std::string& scene_hash, const Activity& activity, std::chrono::milliseconds patience = default_patience);

  const std::string& role() const { return role_; }

  /// Sends a request and waits for its reply.
  template <class Reply, class Request>
  Reply ask(const Request& request) {
    const UnderWay under_way(*this);
    connection_.send(request);
    return connection_.expect<Reply>(patience_);
  }
  /// Sends a request that is answered by OK.
  template <class Request>
  void tell(const Request& request) {
    ask<protocol::Ok>(request);
  }

  void start(const protocol::Run& run) {
    heartbeats_.work_ends();
    next_step_ = run.first_step + run.steps;
    connection_.send(run, run.first_step);
  }
  /// One step's rows, [slots][3]; valid until the next call.
  std::span<const double> receive_gap(std::size_t slots, std::uint64_t step);
  void send_multipliers(std::span<const double> rows, bool stop, std::uint64_t step) {
    connection_.send_multipliers(rows, stop, step);
  }
  protocol::RunDone finish() {
    const UnderWay under_way(*this);
    return connection_.expect<protocol::RunDone>(patience_);
  }

  std::vector<double> fetch(const std::string& field);
  void say_goodbye() {
    tell(protocol::Bye{});
    heartbeats_.work_ends();
  }

  /// Bytes on the wire in both directions.
  std::uint64_t bytes() const { return connection_.bytes_sent() + connection_.bytes_received(); }

  static constexpr std::chrono::seconds connect_deadline{10};
  static constexpr std::chrono::seconds greeting_deadline{5};
  static constexpr std::chrono::milliseconds default_patience{20000};
  static constexpr std::chrono::seconds heartbeat_period{1};

 private:
  /// While the engine works on a request it is not told that the coupler works: only the engine's own heartbeats count.
  class UnderWay {
   public:
    explicit UnderWay(EngineLink& link) : link_(link) { link_.heartbeats_.work_ends(); }
    ~UnderWay() { link_.heartbeats_.work_begins(); }

   private:
    EngineLink& link_;
  };

  protocol::Heartbeat present() const;

  std::string role_;
  protocol::Connection connection_;
  const Activity& activity_;
  std::chrono::milliseconds patience_;
  std::atomic<std::uint64_t> next_step_{0};
  protocol::Heartbeats heartbeats_;  ///< after what it uses
  std::vector<double> gap_;
};

}  // namespace gabion::coupler
