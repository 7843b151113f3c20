#pragma once
// The engines' side of a session: handshake, states, the messages both engines know, and those that an
// engine adds with on<M>(). PROTOCOL.md is the specification.

#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "protocol/engine/engine.hpp"
#include "protocol/session/heartbeat.hpp"
#include "protocol/wire/connection.hpp"

namespace gabion::protocol {

struct SessionOptions {
  std::string software = "unnamed";                       ///< name and version, for WELCOME
  Duration handshake_timeout = std::chrono::seconds(10);  ///< for HELLO
  Duration idle_timeout = std::chrono::seconds(600);      ///< for the next request of a client without heartbeats
  Duration exchange_timeout = std::chrono::seconds(30);   ///< for MULTIPLIERS, and for a client's next heartbeat
  Duration heartbeat_period = std::chrono::seconds(1);
};

class Service {
 public:
  enum class Outcome {
    refused,   ///< no valid HELLO; the engine is untouched and may be offered to another client
    finished,  ///< ended by BYE
  };

  /// role: dem or continuum. capabilities: optional features; each field that FETCH gives as "field:NAME".
  Service(engine::Engine& engine, std::string role, std::vector<std::string> capabilities);
  ~Service();

  /// Registers what to do with a request M: handler(M) returns the reply message. Where M is allowed is
  /// the catalogue's business. The handler may throw: RequestError, std::invalid_argument and
  /// std::out_of_range become ERROR "value", PhysicsError "physics", anything else "internal"; the
  /// session goes on.
  template <class M, class Handler>
  void on(Handler handler) {
    handlers_[M::id] = [this, handler](const Frame& frame) {
      M message;
      Reader reader(frame.payload);
      message.decode(reader);
      reply(handler(std::move(message)));
    };
  }

  /// Serves one client. Throws WireError when the connection fails after the handshake.
  Outcome serve(Connection& connection, const std::string& token, const SessionOptions& options);

  SessionState state() const { return state_; }
  engine::Engine& engine() { return engine_; }

 private:
  bool shake_hands(const std::string& token);
  void serve_request();
  Frame next_request();
  void handle(const Frame& frame);
  void add_shared_messages();
  RunDone run(const Run& request);
  std::optional<engine::Ledger> take_steps(const Run& request, std::uint64_t& taken);
  RunDone summary(const Run& request, std::uint64_t taken, const std::optional<engine::Ledger>& ledger);
  Ready ready_message();

  template <class M>
  void reply(const M& message) {
    heartbeats_->work_ends();
    connection_->send(message, engine_.current_step);
  }
  void reply_error(const std::string& code, const std::string& message, const std::string& where,
                   const std::string& advice);
  /// Turns the exception in flight into an ERROR; rethrows what ends the connection.
  void reply_to_exception(const std::string& request);

  engine::Engine& engine_;
  std::string role_;
  std::vector<std::string> capabilities_;
  std::map<std::uint16_t, std::function<void(const Frame&)>> handlers_;
  SessionOptions options_;
  Connection* connection_ = nullptr;
  std::unique_ptr<Heartbeats> heartbeats_;
  SessionState state_ = SessionState::connected;
  bool client_beats_ = false;                         ///< the client has sent a heartbeat
  std::string awaited_request_ = "the next request";  ///< for errors, with the phase of its last heartbeat
  std::optional<std::uint64_t> checkpoint_step_;      ///< of the last CHECKPOINT
  bool run_failed_ = false;            ///< the last run ended inside a step
  bool multipliers_expected_ = false;  ///< a failed run may have left a GAP whose answer is under way
};

}  // namespace gabion::protocol
