#include "coupler/run/engine_link.hpp"

#include <algorithm>
#include <thread>

namespace gabion::coupler {

namespace {

constexpr std::chrono::microseconds brief_spin{40};
constexpr unsigned processes = 3;  // two engines and the coupler

/// Spinning helps only where each of the three processes has a core of its own.
protocol::ConnectionOptions connection_options() {
  protocol::ConnectionOptions options;
  if (std::thread::hardware_concurrency() >= processes) options.spin = brief_spin;
  return options;
}

}  // namespace

EngineLink::EngineLink(const std::string& role, const protocol::Address& address, const std::string& token,
                       const std::string& scene_hash, const Activity& activity, std::chrono::milliseconds patience)
    : role_(role),
      connection_(protocol::Connection::connect(address.host, address.port, connect_deadline, role + "_server",
                                                connection_options())),
      activity_(activity),
      patience_(patience),
      heartbeats_(connection_, [this] { return present(); }, heartbeat_period) {
  protocol::Hello hello;
  hello.protocol_version = protocol::protocol_version;
  hello.token = token;
  hello.role = "coupler";
  hello.scene_hash = scene_hash;
  hello.software = "gabion coupler";
  connection_.send(hello);
  const auto welcome = connection_.expect<protocol::Welcome>(std::min<std::chrono::milliseconds>(greeting_deadline, patience_));
  if (welcome.role != role)
    throw protocol::AddressError("the engine at " + address.host + ":" + std::to_string(address.port) + " is '" + welcome.role +
                                  "', but '" + role + "' was wanted: swap --dem and --continuum");
  connection_.send(present());  // from the first on the engine counts on the others
  heartbeats_.work_begins();
}

protocol::Heartbeat EngineLink::present() const {
  protocol::Heartbeat heartbeat;
  heartbeat.phase = activity_.phase();
  heartbeat.step = next_step_;
  return heartbeat;
}

std::span<const double> EngineLink::receive_gap(std::size_t slots, std::uint64_t step) {
  gap_.resize(3 * slots);
  connection_.receive_gap(gap_, step, patience_);
  return gap_;
}

std::vector<double> EngineLink::fetch(const std::string& field) {
  protocol::Fetch fetch;
  fetch.field = field;
  return std::move(ask<protocol::Field>(fetch).values.data);
}

}  // namespace gabion::coupler
