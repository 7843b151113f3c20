#include "protocol/wire/connection.hpp"

#include <boost/asio/buffer.hpp>
#include <cstdio>
#include <cstring>

#include "protocol/wire/socket.hpp"

namespace gabion::protocol {

namespace asio = boost::asio;
using Bytes = std::span<const std::byte>;

namespace {

constexpr std::size_t usual_buffer = std::size_t{1} << 16;         ///< bytes; a step's frame fits
constexpr std::size_t kept_buffer = std::size_t{1} << 24;          ///< bytes; larger ones are given back after use
constexpr std::size_t array_head = 1 + 2 * sizeof(std::uint64_t);  ///< bytes before the values of an [r,3] array

std::string seconds_text(Duration time) {
  std::array<char, 32> text;
  std::snprintf(text.data(), text.size(), "%g s", std::chrono::duration<double>(time).count());
  return text.data();
}

/// The bytes before the values of an [r,3] array.
std::array<std::byte, array_head> rows_head(std::size_t values) {
  std::array<std::byte, array_head> head;
  const std::array<std::uint64_t, 2> shape{values / 3, 3};
  head[0] = std::byte{2};
  std::memcpy(head.data() + 1, shape.data(), sizeof shape);
  return head;
}

}  // namespace

Connection::Connection(std::unique_ptr<Socket> socket, std::string peer, ConnectionOptions options)
    : socket_(std::move(socket)),
      peer_(std::move(peer)),
      options_(options),
      send_mutex_(std::make_unique<std::mutex>()),
      incoming_(usual_buffer) {
  socket_->handle.non_blocking(true);
  socket_->handle.set_option(asio::ip::tcp::no_delay(true));
}

Connection::Connection(Connection&&) noexcept = default;
Connection::~Connection() = default;

void Connection::close() {
  boost::system::error_code ignored;  // a connection that is gone is closed as well
  socket_->handle.shutdown(asio::ip::tcp::socket::shutdown_both, ignored);
  socket_->handle.close(ignored);
}

// ---- sending

void Connection::send_gap(std::span<const double> rows, std::uint64_t step) {
  const std::lock_guard lock(*send_mutex_);
  const auto head = rows_head(rows.size());
  const std::array<Bytes, 2> parts{head, std::as_bytes(rows)};
  send_parts(Gap::id, step, parts);
}

void Connection::send_multipliers(std::span<const double> rows, bool stop, std::uint64_t step) {
  const std::lock_guard lock(*send_mutex_);
  const std::array<std::byte, 1> flag{std::byte{stop}};
  const auto head = rows_head(rows.size());
  const std::array<Bytes, 3> parts{flag, head, std::as_bytes(rows)};
  send_parts(Multipliers::id, step, parts);
}

/// One vectored write of header and payload; the caller holds send_mutex_.
void Connection::send_parts(std::uint16_t type, std::uint64_t step, std::span<const Bytes> payload) {
  const HeaderBytes header = encode_header({.type = type, .sequence = next_sent_, .step = step}, payload);
  std::array<asio::const_buffer, 4> buffers;
  buffers[0] = asio::buffer(header.data(), header.size());
  for (std::size_t i = 0; i < payload.size(); ++i) buffers[i + 1] = asio::buffer(payload[i].data(), payload[i].size());
  const auto while_sending = [&] { return "sending " + message_name(type); };
  const Clock::time_point deadline = Clock::now() + options_.send_timeout;
  std::size_t left = asio::buffer_size(buffers);
  bytes_sent_ += left;
  while (left > 0) {
    boost::system::error_code error;
    std::size_t written = socket_->handle.write_some(buffers, error);
    if (error == asio::error::would_block || error == asio::error::try_again) {
      if (!wait_ready(socket_->handle.native_handle(), POLLOUT, deadline)) {
        close();  // half a frame is under way: nothing can follow it
        throw Timeout(peer_, while_sending(), step,
                      "does not take what is sent to it, for " + seconds_text(options_.send_timeout));
      }
      continue;
    }
    if (error) throw ConnectionLost(peer_, while_sending(), step, "the connection is lost, " + error.message());
    left -= written;
    for (asio::const_buffer& buffer : buffers) {
      const std::size_t done = std::min(written, buffer.size());
      buffer += done;
      written -= done;
    }
  }
  ++next_sent_;
  if (outgoing_.capacity() > kept_buffer) std::vector<std::byte>().swap(outgoing_);
}

// ---- receiving

Frame Connection::receive(Duration timeout, const char* awaited) {
  awaited_ = awaited;
  if (begin_ == end_) {
    begin_ = end_ = 0;
    if (incoming_.size() > kept_buffer) std::vector<std::byte>(usual_buffer).swap(incoming_);
  }
  const Clock::time_point deadline = Clock::now() + timeout;
  const auto header_at = [&] {
    return std::span<const std::byte, FrameHeader::bytes>(&incoming_[begin_], FrameHeader::bytes);
  };
  FrameHeader header;
  try {
    fill(FrameHeader::preamble_bytes, deadline, timeout);
    check_preamble(
        std::span<const std::byte, FrameHeader::preamble_bytes>(&incoming_[begin_], FrameHeader::preamble_bytes));
    fill(FrameHeader::bytes, deadline, timeout);
    header = decode_header(header_at(), options_.payload_limit);
    fill(FrameHeader::bytes + header.length, deadline, timeout);
    verify_checksum(header_at(), {incoming_.data() + begin_ + FrameHeader::bytes, header.length});
  } catch (const VersionError& error) {
    raise<VersionMismatch>(error.what());
  } catch (const FrameError& error) {
    raise<ProtocolError>(error.what());
  }
  if (header.sequence != next_received_)
    raise<ProtocolError>("frame number " + std::to_string(header.sequence) + " came where " +
                         std::to_string(next_received_) + " is due");
  ++next_received_;
  const Frame frame{header, {incoming_.data() + begin_ + FrameHeader::bytes, header.length}};
  begin_ += FrameHeader::bytes + header.length;
  bytes_received_ += FrameHeader::bytes + header.length;
  return frame;
}

void Connection::fill(std::size_t count, Clock::time_point deadline, Duration timeout) {
  const Clock::time_point spin_end = Clock::now() + options_.spin;
  while (end_ - begin_ < count) {
    if (end_ == incoming_.size()) make_room(count);
    boost::system::error_code error;
    end_ += socket_->handle.read_some(asio::buffer(&incoming_[end_], incoming_.size() - end_), error);
    if (!error) continue;
    const auto waiting = [&] { return "waiting for " + std::string(awaited_); };
    if (error != asio::error::would_block && error != asio::error::try_again)
      throw ConnectionLost(
          peer_, waiting(), step_,
          error == asio::error::eof ? "closed the connection" : "the connection is lost, " + error.message());
    if (Clock::now() < spin_end) continue;
    if (!wait_ready(socket_->handle.native_handle(), POLLIN, deadline))
      throw Timeout(peer_, waiting(), step_, "did not answer within " + seconds_text(timeout));
  }
}

/// Takes memory as bytes come, not as a header promises them.
void Connection::make_room(std::size_t count) {
  if (begin_ > 0) {
    std::memmove(incoming_.data(), incoming_.data() + begin_, end_ - begin_);
    end_ -= begin_;
    begin_ = 0;
  }
  if (end_ == incoming_.size()) incoming_.resize(std::min(count, 2 * incoming_.size()));
}

Frame Connection::receive_type(std::uint16_t type, Duration timeout) {
  const char* awaited = find_message(type)->name.data();
  const Clock::time_point last = Clock::now() + options_.longest_wait;
  for (;;) {
    const Frame frame = receive(std::min(timeout, last - Clock::now()), awaited);
    if (frame.header.type == type) return frame;
    if (frame.header.type == Heartbeat::id) {
      Heartbeat heartbeat;
      decode(frame, heartbeat);
      if (on_heartbeat) on_heartbeat(heartbeat);
    } else if (frame.header.type == Error::id) {
      Error error;
      decode(frame, error);
      throw RemoteError(peer_, "waiting for " + std::string(awaited), error.step, error.code, error.message,
                        error.where, error.advice);
    } else {
      raise<UnexpectedMessage>(message_name(frame.header.type) + " came where " + awaited + " is due");
    }
  }
}

void Connection::receive_gap(std::span<double> rows, std::uint64_t step, Duration timeout) {
  step_ = step;
  receive_rows(receive_type(Gap::id, timeout), 0, rows, step);
}

bool Connection::receive_multipliers(std::span<double> rows, std::uint64_t step, Duration timeout) {
  step_ = step;
  const Frame frame = receive_type(Multipliers::id, timeout);
  receive_rows(frame, 1, rows, step);
  return frame.payload[0] != std::byte{0};
}

void Connection::receive_rows(const Frame& frame, std::size_t prefix, std::span<double> rows, std::uint64_t step) {
  const std::string name = message_name(frame.header.type);
  if (frame.header.step != step)
    raise<BadMessage>(name + " of step " + std::to_string(frame.header.step) + " came where that of step " +
                      std::to_string(step) + " is due");
  const auto head = rows_head(rows.size());
  if (frame.payload.size() != prefix + array_head + rows.size_bytes() ||
      std::memcmp(frame.payload.data() + prefix, head.data(), head.size()) != 0)
    raise<BadMessage>(name + " of " + std::to_string(frame.payload.size()) + " bytes came where [" +
                      std::to_string(rows.size() / 3) + ",3] values are due");
  std::memcpy(rows.data(), frame.payload.data() + prefix + array_head, rows.size_bytes());
}

}  // namespace gabion::protocol
