// Time of a step's exchange between processes: GAP one way, MULTIPLIERS the other.
//
//   bench_exchange [rows] [engines]

#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <vector>

#include "protocol/wire/connection.hpp"

using namespace gabion::protocol;

namespace {

constexpr std::uint64_t exchanges = 20000;
constexpr auto patience = std::chrono::seconds(10);

void be_engine(const Address& address, std::size_t rows, ConnectionOptions options) {
  Connection coupler = Connection::connect(address.host, address.port, patience, "coupler", options);
  std::vector<double> values(3 * rows, 1.5);
  for (std::uint64_t step = 0; step < exchanges; ++step) {
    coupler.send_gap(values, step);
    coupler.receive_multipliers(values, step, patience);
  }
}

void measure(std::size_t rows, std::size_t engines, ConnectionOptions options) {
  Listener listener({"127.0.0.1", 0});
  const Address address = listener.address();
  std::vector<pid_t> children;
  for (std::size_t e = 0; e < engines; ++e) {
    const pid_t child = ::fork();
    if (child == 0) {
      be_engine(address, rows, options);
      std::_Exit(0);
    }
    children.push_back(child);
  }
  std::vector<Connection> links;
  for (std::size_t e = 0; e < engines; ++e) links.push_back(listener.accept(patience, "engine", options));
  std::vector<double> values(3 * rows), microseconds;
  auto last = Clock::now();
  for (std::uint64_t step = 0; step < exchanges; ++step) {
    for (Connection& link : links) link.receive_gap(values, step, patience);
    for (Connection& link : links) link.send_multipliers(values, false, step);
    const auto now = Clock::now();
    microseconds.push_back(std::chrono::duration<double, std::micro>(now - last).count());
    last = now;
  }
  const double sent = static_cast<double>(links[0].bytes_sent()) / exchanges;
  const double received = static_cast<double>(links[0].bytes_received()) / exchanges;
  for (const pid_t child : children) ::waitpid(child, nullptr, 0);
  std::sort(microseconds.begin(), microseconds.end());
  double total = 0;
  for (const double t : microseconds) total += t;
  std::printf(
      "%zu engines  %4zu rows  spin %3ld us   mean %6.1f  median %6.1f  p99 %7.1f us   GAP %.0f  MULTIPLIERS %.0f "
      "bytes\n",
      engines, rows, static_cast<long>(options.spin.count()), total / exchanges, microseconds[exchanges / 2],
      microseconds[exchanges * 99 / 100], received, sent);
}

}  // namespace

int main(int argc, char** argv) {
  const std::size_t rows = argc > 1 ? std::strtoul(argv[1], nullptr, 10) : 300;
  const std::size_t engines = argc > 2 ? std::strtoul(argv[2], nullptr, 10) : 1;
  for (const int spin : {0, 30, 50, 200}) {
    ConnectionOptions options;
    options.spin = std::chrono::microseconds(spin);
    measure(rows, engines, options);
  }
  return 0;
}
