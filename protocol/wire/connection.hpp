#pragma once
// One TCP connection that carries frames: every wait has a deadline, every error names the other side.

#include <chrono>
#include <cstdint>
#include <functional>
#include <memory>
#include <mutex>
#include <span>
#include <string>
#include <vector>

#include "protocol/messages.hpp"
#include "protocol/wire/codec.hpp"
#include "protocol/wire/errors.hpp"
#include "protocol/wire/frame.hpp"

namespace gabion::protocol {

using Clock = std::chrono::steady_clock;
using Duration = Clock::duration;

struct ConnectionOptions {
  /// A wait first looks again and again for this long, then sleeps until bytes come. 0 on a machine
  /// with fewer cores than busy processes.
  std::chrono::microseconds spin{0};
  /// Frames with more payload are refused, bytes.
  std::uint64_t payload_limit = std::uint64_t{1} << 34;
  /// Longest time in which the other side must take what is sent to it.
  Duration send_timeout = std::chrono::seconds(60);
  /// A wait that heartbeats keep alive still ends after this time.
  Duration longest_wait = std::chrono::hours(24);
};

/// An open socket; defined in connection.cpp.
class Socket;

/// Sending may be done by several threads at once, receiving by one. Throws the types of errors.hpp.
class Connection {
 public:
  /// Connects, trying again while the other side refuses, until timeout. peer names it in errors.
  static Connection connect(const std::string& host, std::uint16_t port, Duration timeout, const std::string& peer,
                            ConnectionOptions options = {});
  Connection(std::unique_ptr<Socket> socket, std::string peer, ConnectionOptions options);
  Connection(Connection&&) noexcept;
  ~Connection();

  template <class M>
  void send(const M& message, std::uint64_t step = 0) {
    const std::lock_guard lock(*send_mutex_);
    outgoing_.clear();
    Writer writer(outgoing_);
    message.encode(writer);
    const std::span<const std::byte> part = outgoing_;
    send_parts(M::id, step, {&part, 1});
  }

  /// One GAP, [rows][3], straight from the caller's memory.
  void send_gap(std::span<const double> rows, std::uint64_t step);
  /// One MULTIPLIERS, [rows][3], straight from the caller's memory.
  void send_multipliers(std::span<const double> rows, bool stop, std::uint64_t step);
  /// The GAP of this step into rows; BadMessage when it has another step or size.
  void receive_gap(std::span<double> rows, std::uint64_t step, Duration timeout);
  /// The MULTIPLIERS of this step into rows; true when this is the last step of the run.
  bool receive_multipliers(std::span<double> rows, std::uint64_t step, Duration timeout);

  /// The next frame, whatever it is; awaited completes "waiting for ..." in errors.
  Frame receive(Duration timeout, const char* awaited);

  /// Waits for M. HEARTBEAT is reported to on_heartbeat and starts the wait anew, ERROR becomes
  /// RemoteError, anything else UnexpectedMessage.
  template <class M>
  M expect(Duration timeout) {
    M message;
    expect(message, timeout);
    return message;
  }
  /// The same into a message that is kept, so that its memory is used again.
  template <class M>
  void expect(M& message, Duration timeout) {
    decode(receive_type(M::id, timeout), message);
  }
  /// Decodes a frame; BadMessage when its payload is not an M.
  template <class M>
  void decode(const Frame& frame, M& message) {
    try {
      Reader reader(frame.payload);
      message.decode(reader);
    } catch (const CodecError& error) {
      raise<BadMessage>(error.what());
    }
  }

  /// Step that errors of the waits to come shall name; the exchange of a step sets it by itself.
  void at_step(std::uint64_t step) { step_ = step; }
  std::uint64_t payload_limit() const { return options_.payload_limit; }
  void set_payload_limit(std::uint64_t bytes) { options_.payload_limit = bytes; }
  const std::string& peer() const { return peer_; }
  void set_peer(std::string peer) { peer_ = std::move(peer); }
  /// Ends the connection; later calls throw ConnectionLost.
  void close();
  /// Bytes on the wire since the connection was made.
  std::uint64_t bytes_sent() const {
    const std::lock_guard lock(*send_mutex_);
    return bytes_sent_;
  }
  std::uint64_t bytes_received() const { return bytes_received_; }

  std::function<void(const Heartbeat&)> on_heartbeat;

 private:
  void send_parts(std::uint16_t type, std::uint64_t step, std::span<const std::span<const std::byte>> payload);
  Frame receive_type(std::uint16_t type, Duration timeout);
  void receive_rows(const Frame& frame, std::size_t prefix, std::span<double> rows, std::uint64_t step);
  /// Waits until count bytes from the start of the next frame are in incoming_.
  void fill(std::size_t count, Clock::time_point deadline, Duration timeout);
  void make_room(std::size_t count);
  template <class E>
  [[noreturn]] void raise(const std::string& what) {
    throw E(peer_, "waiting for " + std::string(awaited_), step_, what);
  }

  std::unique_ptr<Socket> socket_;
  std::string peer_;
  ConnectionOptions options_;
  std::unique_ptr<std::mutex> send_mutex_;
  std::vector<std::byte> outgoing_;
  std::vector<std::byte> incoming_;  ///< bytes [begin_, end_) are received and not yet consumed
  std::size_t begin_ = 0, end_ = 0;
  std::uint64_t next_sent_ = 0, next_received_ = 0;  ///< sequence numbers
  std::uint64_t step_ = 0;
  std::uint64_t bytes_sent_ = 0, bytes_received_ = 0;
  const char* awaited_ = "HELLO";  ///< name of the message waited for
};

struct Address {
  std::string host;
  std::uint16_t port = 0;
};
/// "host:port" or "[v6 address]:port"; AddressError says what is wrong.
Address parse_address(const std::string& text);

/// Waits for connections on one port.
class Listener {
 public:
  /// Port 0 takes a free one. AddressError when the port is taken or the host is not this machine's.
  explicit Listener(const Address& address);
  ~Listener();

  Address address() const;
  /// Timeout when nobody connects.
  Connection accept(Duration timeout, const std::string& peer, ConnectionOptions options = {});

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace gabion::protocol
