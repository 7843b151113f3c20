#pragma once
// The step's exchange over a connection.

#include "protocol/engine/engine.hpp"
#include "protocol/engine/tie.hpp"
#include "protocol/wire/connection.hpp"

namespace gabion::protocol {

/// Sends GAP and receives MULTIPLIERS at engine.current_step. Values that are not finite are a
/// PhysicsError on either way, so that they cannot spread to the other engine.
class ConnectionExchange : public engine::Exchange {
 public:
  ConnectionExchange(Connection& connection, const engine::Engine& engine, Duration timeout)
      : connection_(connection), engine_(engine), timeout_(timeout) {}

  void send_gap(std::span<const double> rows) override;
  bool receive_multipliers(std::span<double> rows) override;

  /// True when a GAP was sent whose answer may still come.
  bool answer_is_due() const { return answer_is_due_; }
  bool stopped() const { return stopped_; }

 private:
  Connection& connection_;
  const engine::Engine& engine_;
  Duration timeout_;
  bool answer_is_due_ = false;
  bool stopped_ = false;
};

}  // namespace gabion::protocol
