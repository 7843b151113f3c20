// Making connections: addresses, connecting with a deadline, listening.

#include <sys/socket.h>

#include <charconv>
#include <thread>

#include "protocol/wire/connection.hpp"
#include "protocol/wire/socket.hpp"

namespace gabion::protocol {

namespace asio = boost::asio;
using asio::ip::tcp;

namespace {

constexpr auto retry_pause = std::chrono::milliseconds(20);

/// One attempt at one endpoint; the error, or none.
boost::system::error_code try_connect(Socket& socket, const tcp::endpoint& endpoint, Clock::time_point deadline) {
  boost::system::error_code error;
  socket.handle.close(error);
  socket.handle.open(endpoint.protocol(), error);
  if (error) return error;
  socket.handle.non_blocking(true);
  // Asio's own connect waits without a deadline.
  if (::connect(socket.handle.native_handle(), endpoint.data(), static_cast<socklen_t>(endpoint.size())) == 0)
    return {};
  if (errno != EINPROGRESS) return {errno, boost::system::system_category()};
  if (!wait_ready(socket.handle.native_handle(), POLLOUT, deadline)) return asio::error::timed_out;
  int result = 0;
  socklen_t size = sizeof result;
  ::getsockopt(socket.handle.native_handle(), SOL_SOCKET, SO_ERROR, &result, &size);
  return {result, boost::system::system_category()};
}

std::string text_of(const std::string& host, std::uint16_t port) {
  return (host.find(':') == std::string::npos ? host : "[" + host + "]") + ":" + std::to_string(port);
}

}  // namespace

Connection Connection::connect(const std::string& host, std::uint16_t port, Duration timeout, const std::string& peer,
                               ConnectionOptions options) {
  const std::string name = peer + " at " + text_of(host, port);
  const Clock::time_point deadline = Clock::now() + timeout;
  auto socket = std::make_unique<Socket>();
  boost::system::error_code error;
  const auto found = tcp::resolver(socket->context).resolve(host, std::to_string(port), error);
  if (error) throw AddressError(name + ": cannot find the host, " + error.message() + "; check the address");
  for (;;) {
    for (const auto& entry : found) {
      error = try_connect(*socket, entry.endpoint(), deadline);
      if (!error) return Connection(std::move(socket), name, options);
    }
    if (Clock::now() + retry_pause >= deadline)
      throw ConnectionLost(name, "connecting", 0, "cannot be reached, " + error.message() + "; is it running?");
    std::this_thread::sleep_for(retry_pause);
  }
}

Address parse_address(const std::string& text) {
  const auto refuse = [&]() {
    return AddressError("'" + text + "' is no address; expected host:port, as in 127.0.0.1:0");
  };
  const std::size_t colon = text.rfind(':');
  if (colon == std::string::npos || colon == 0) throw refuse();
  Address address;
  address.host = text.substr(0, colon);
  if (address.host.front() == '[') {
    if (address.host.back() != ']') throw refuse();
    address.host = address.host.substr(1, address.host.size() - 2);
  }
  const char* last = text.data() + text.size();
  const auto [end, error] = std::from_chars(text.data() + colon + 1, last, address.port);
  if (error != std::errc{} || end != last) throw refuse();
  return address;
}

struct Listener::State {
  asio::io_context context;
  tcp::acceptor acceptor{context};
};

Listener::Listener(const Address& address) : state_(std::make_unique<State>()) {
  boost::system::error_code error;
  const auto refuse = [&](const std::string& advice) {
    return AddressError("cannot listen on " + text_of(address.host, address.port) + ": " + error.message() + advice);
  };
  const auto found =
      tcp::resolver(state_->context).resolve(address.host, std::to_string(address.port), tcp::resolver::passive, error);
  if (error) throw refuse("");
  const tcp::endpoint endpoint = found.begin()->endpoint();
  tcp::acceptor& acceptor = state_->acceptor;
  acceptor.open(endpoint.protocol(), error);
  if (error) throw refuse("");
  // Lets a port be used again whose last connection is still dying; a port that is listened on stays refused.
  acceptor.set_option(tcp::acceptor::reuse_address(true), error);
  acceptor.bind(endpoint, error);
  if (!error) acceptor.listen(asio::socket_base::max_listen_connections, error);
  if (error) throw refuse("; choose another port, or 0 for a free one");
  acceptor.non_blocking(true);
}

Listener::~Listener() = default;

Address Listener::address() const {
  const tcp::endpoint endpoint = state_->acceptor.local_endpoint();
  return {endpoint.address().to_string(), endpoint.port()};
}

Connection Listener::accept(Duration timeout, const std::string& peer, ConnectionOptions options) {
  const Clock::time_point deadline = Clock::now() + timeout;
  for (;;) {
    auto socket = std::make_unique<Socket>();
    tcp::endpoint from;
    boost::system::error_code error;
    state_->acceptor.accept(socket->handle, from, error);
    if (!error)
      return Connection(std::move(socket), peer + " at " + text_of(from.address().to_string(), from.port()), options);
    const bool nobody = error == asio::error::would_block || error == asio::error::try_again;
    if (!nobody && error != asio::error::connection_aborted)
      throw ConnectionLost(peer, "waiting for a connection", 0, error.message());
    if (!wait_ready(state_->acceptor.native_handle(), POLLIN, deadline))
      throw Timeout(peer, "waiting for a connection", 0,
                    "nobody connected within " +
                        std::to_string(std::chrono::duration_cast<std::chrono::seconds>(timeout).count()) + " s");
  }
}

}  // namespace gabion::protocol
