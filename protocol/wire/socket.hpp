#pragma once
// The system's TCP socket in non-blocking mode; only the wire's own sources include this.

#include <poll.h>

#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <chrono>

#include "protocol/wire/connection.hpp"

namespace gabion::protocol {

class Socket {
 public:
  boost::asio::io_context context;
  boost::asio::ip::tcp::socket handle{context};
};

/// Sleeps until the descriptor is ready for events (POLLIN, POLLOUT); false when the deadline passed.
inline bool wait_ready(int descriptor, short events, Clock::time_point deadline) {
  for (;;) {
    const auto left = std::max(Duration::zero(), deadline - Clock::now());
    const auto seconds = std::chrono::duration_cast<std::chrono::seconds>(left);
    const timespec limit{static_cast<time_t>(seconds.count()),
                         static_cast<long>(std::chrono::nanoseconds(left - seconds).count())};
    pollfd request{descriptor, events, 0};
    const int ready = ::ppoll(&request, 1, &limit, nullptr);
    if (ready > 0) return true;
    if (ready == 0) return false;
    if (errno != EINTR) return true;  // the call on the socket that follows reports what is wrong
  }
}

}  // namespace gabion::protocol
