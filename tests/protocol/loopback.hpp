#pragma once
// Two connected ends in one process.

#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <future>
#include <thread>

#include "protocol/wire/connection.hpp"

namespace gabion::protocol {

struct Loopback {
  explicit Loopback(ConnectionOptions options = {}) {
    Listener listener({"127.0.0.1", 0});
    client = std::make_unique<Connection>(
        Connection::connect("127.0.0.1", listener.address().port, std::chrono::seconds(5), "engine", options));
    server = std::make_unique<Connection>(listener.accept(std::chrono::seconds(5), "coupler", options));
  }
  std::unique_ptr<Connection> client, server;
};

/// A connection whose other side is a bare socket that can send any bytes.
struct RawPeer {
  RawPeer() {
    Listener listener({"127.0.0.1", 0});
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_port = htons(listener.address().port);
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    descriptor = ::socket(AF_INET, SOCK_STREAM, 0);
    if (::connect(descriptor, reinterpret_cast<const sockaddr*>(&address), sizeof address) != 0)
      throw std::runtime_error("cannot connect");
    connection = std::make_unique<Connection>(listener.accept(std::chrono::seconds(5), "coupler"));
  }
  ~RawPeer() { ::close(descriptor); }

  void send(std::span<const std::byte> bytes) const {
    if (::send(descriptor, bytes.data(), bytes.size(), MSG_NOSIGNAL) != static_cast<ssize_t>(bytes.size()))
      throw std::runtime_error("cannot send");
  }

  int descriptor;
  std::unique_ptr<Connection> connection;
};

/// s that a call takes.
template <class Call>
double seconds_of(Call&& call) {
  const auto start = Clock::now();
  call();
  return std::chrono::duration<double>(Clock::now() - start).count();
}

}  // namespace gabion::protocol
