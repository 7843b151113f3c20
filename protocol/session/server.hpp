#pragma once
// The main function of an engine: options, token, listening, one client, exit status.

#include <functional>
#include <string>

#include "protocol/session/service.hpp"
#include "protocol/wire/connection.hpp"

namespace gabion::protocol {

struct ServerSettings {
  Address listen{"127.0.0.1", 0};
  int threads = 1;
  std::string token;
  Duration accept_timeout = std::chrono::seconds(60);
  SessionOptions session;
  ConnectionOptions connection;
};

/// Offers a service to one client.
class Server {
 public:
  explicit Server(ServerSettings settings) : settings_(std::move(settings)) {}

  /// Sets the engine's threads, prints LISTENING, waits for a client with the token and serves it until
  /// BYE. Clients without it are turned away. Throws AddressError and WireError.
  void run(Service& service);

 private:
  ServerSettings settings_;
};

/// Reads the options, prepares the threads and calls body, which makes engine and service and calls
/// server.run(service). Returns the exit status: 0 after BYE, 2 for wrong usage, 1 for anything else.
int serve_main(int argc, char** argv, const std::string& name, const std::function<void(Server&)>& body);

}  // namespace gabion::protocol
