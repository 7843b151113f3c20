#include "protocol/session/service.hpp"

#include <iostream>

namespace gabion::protocol {

namespace {

/// Before the token was checked nobody may make this process take memory, bytes.
constexpr std::uint64_t handshake_payload = 4096;

/// Takes the same time wherever the first difference is.
bool same_token(const std::string& given, const std::string& token) {
  std::size_t difference = given.size() ^ token.size();
  for (std::size_t i = 0; i < given.size(); ++i)
    difference |= static_cast<unsigned char>(given[i] ^ token[i % token.size()]);
  return difference == 0 && !token.empty();
}

}  // namespace

Service::Service(engine::Engine& engine, std::string role, std::vector<std::string> capabilities)
    : engine_(engine), role_(std::move(role)), capabilities_(std::move(capabilities)) {
  add_shared_messages();
}

Service::~Service() = default;

Service::Outcome Service::serve(Connection& connection, const std::string& token, const SessionOptions& options) {
  connection_ = &connection;
  options_ = options;
  state_ = SessionState::connected;
  if (!shake_hands(token)) return Outcome::refused;
  const auto present = [this] {
    Heartbeat heartbeat;
    heartbeat.phase = engine_.phase.load();
    heartbeat.step = engine_.current_step;
    return heartbeat;
  };
  heartbeats_ = std::make_unique<Heartbeats>(connection, present, options.heartbeat_period);
  try {
    while (state_ != SessionState::closed) serve_request();
  } catch (const WireError&) {
    if (checkpoint_step_) std::cerr << "the client's last CHECKPOINT was at step " << *checkpoint_step_ << '\n';
    throw;
  }
  return Outcome::finished;
}

bool Service::shake_hands(const std::string& token) {
  const std::uint64_t usual_payload = connection_->payload_limit();
  connection_->set_payload_limit(handshake_payload);
  const auto refuse = [&](const std::string& code, const std::string& message, const std::string& advice) {
    std::cerr << connection_->peer() << " refused: " << message << '\n';
    reply_error(code, message, "HELLO", advice);
    return false;
  };
  try {
    const std::string version = std::to_string(protocol_version);
    const std::string same_release = "use programs of the same release";
    Hello hello;
    try {
      const Frame frame = connection_->receive(options_.handshake_timeout, "HELLO");
      if (frame.header.type != Hello::id)
        return refuse("state", message_name(frame.header.type) + " came before HELLO", "send HELLO first");
      connection_->decode(frame, hello);
    } catch (const VersionMismatch& error) {
      return refuse("version", error.what(), same_release);
    }
    if (hello.protocol_version != protocol_version)
      return refuse("version",
                    "the client speaks version " + std::to_string(hello.protocol_version) +
                        " of the protocol, the engine " + version,
                    same_release);
    if (!same_token(hello.token, token))
      return refuse("token", "the token is not the one this engine was started with",
                    "give both programs the same GABION_TOKEN");
    Welcome welcome;
    welcome.protocol_version = protocol_version;
    welcome.role = role_;
    welcome.capabilities = capabilities_;
    welcome.threads = static_cast<std::uint32_t>(engine_.threads);
    welcome.software = options_.software;
    connection_->send(welcome);
  } catch (const WireError& error) {
    std::cerr << "handshake failed: " << error.what() << '\n';
    return false;
  }
  connection_->set_payload_limit(usual_payload);
  state_ = SessionState::configuring;
  return true;
}

void Service::serve_request() {
  const Frame frame = next_request();
  const bool late_answer = multipliers_expected_ && frame.header.type == Multipliers::id;
  multipliers_expected_ = false;
  // An ERROR outside a run tells of trouble elsewhere; there is nothing here to end.
  if (late_answer || frame.header.type == Error::id) return;
  const std::string name = message_name(frame.header.type);
  try {
    handle(frame);
  } catch (...) {
    reply_to_exception(name);
  }
  engine_.phase = "idle";
}

/// Waits for a request. A client that has sent a heartbeat is known to send them, and is gone when they cease.
Frame Service::next_request() {
  connection_->at_step(engine_.current_step);
  for (;;) {
    const Duration deadline = client_beats_ ? options_.exchange_timeout : options_.idle_timeout;
    try {
      const Frame frame = connection_->receive(deadline, awaited_request_.c_str());
      if (frame.header.type != Heartbeat::id) return frame;
      Heartbeat heartbeat;
      connection_->decode(frame, heartbeat);
      client_beats_ = true;
      awaited_request_ = "the next request, last heard of it at '" + heartbeat.phase + "'";
    } catch (const Timeout& error) {
      reply_error("timeout", error.what(), "",
                  client_beats_ ? "send a heartbeat a second between requests, or start the engine with a longer --io-timeout"
                                : "send a request or BYE within the idle time of the engine");
      throw;
    }
  }
}

void Service::handle(const Frame& frame) {
  const MessageInfo* info = find_message(frame.header.type);
  if (info != nullptr && !info->allowed_in(state_)) {
    std::string allowed;
    for (const SessionState s :
         {SessionState::connected, SessionState::configuring, SessionState::ready, SessionState::running})
      if (info->allowed_in(s)) allowed += (allowed.empty() ? "" : " or ") + std::string(state_name(s));
    return reply_error("state",
                       std::string(info->name) + " is not allowed in the state " + std::string(state_name(state_)),
                       std::string(info->name), "it is allowed in the state " + allowed);
  }
  const auto handler = handlers_.find(frame.header.type);
  if (info == nullptr || handler == handlers_.end())
    throw engine::RequestError(message_name(frame.header.type), "the " + role_ + " engine does not know this request",
                               "send only what PROTOCOL.md lists for this engine");
  if (info->reconfigures) state_ = SessionState::configuring;  // even when it fails half-way
  engine_.phase = info->name.data();
  heartbeats_->work_begins();
  handler->second(frame);
  heartbeats_->work_ends();
}

void Service::reply_to_exception(const std::string& request) {
  heartbeats_->work_ends();
  try {
    throw;
  } catch (const CodecError& error) {
    reply_error("value", error.what(), request, "encode the message as PROTOCOL.md says");
  } catch (const engine::RequestError& error) {
    reply_error("value", error.what(), error.where, error.advice);
  } catch (const engine::PhysicsError& error) {
    reply_error("physics", error.what(), error.where, error.advice);
  } catch (const UnexpectedMessage& error) {
    reply_error("state", error.what(), request, "answer every GAP with MULTIPLIERS");
  } catch (const BadMessage& error) {
    reply_error("value", error.what(), request, "encode the message as PROTOCOL.md says");
  } catch (const RemoteError& error) {
    // The client ended the run and knows it: no answer.
    std::cerr << error.what() << '\n';
  } catch (const Timeout& error) {
    reply_error("timeout", error.what(), request, "answer in time, or start the engine with a longer --io-timeout");
    throw;
  } catch (const WireError&) {
    throw;
  } catch (const std::invalid_argument& error) {
    reply_error("value", error.what(), request, "");
  } catch (const std::out_of_range& error) {
    reply_error("value", error.what(), request, "");
  } catch (const std::exception& error) {
    reply_error("internal", error.what(), request, "this is a fault of the engine: report it with the scene");
  }
}

void Service::reply_error(const std::string& code, const std::string& message, const std::string& where,
                          const std::string& advice) {
  Error error;
  error.code = code;
  error.message = message;
  error.where = where;
  error.advice = advice;
  error.step = engine_.current_step;
  connection_->send(error, error.step);
}

}  // namespace gabion::protocol
