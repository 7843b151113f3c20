#pragma once
// A session between the test, as the coupler, and an engine served by a thread of the same process.

#include "loopback.hpp"
#include "protocol/session/service.hpp"
#include "spring_engine.hpp"

namespace gabion::protocol {

struct Session {
  static constexpr const char* token = "correct horse";
  static constexpr auto patience = std::chrono::seconds(5);
  static constexpr std::size_t points = 8;

  engine::SpringEngine engine{points};
  SessionOptions options;
  Loopback link;
  std::future<Service::Outcome> outcome;

  /// The client goes first, so that the engine's thread ends.
  ~Session() { link.client->close(); }

  /// Starts serving; nothing is said yet.
  void serve() {
    outcome = std::async(std::launch::async, [this] {
      Service service(engine, "dem", {"field:displacement"});
      struct Closing {  // as the process would by ending
        Connection& connection;
        ~Closing() { connection.close(); }
      } closing{*link.server};
      return service.serve(*link.server, token, options);
    });
  }
  Connection& client() { return *link.client; }

  template <class M>
  M ask_for(const auto& request) {
    client().send(request);
    return client().expect<M>(patience);
  }
  /// The ERROR that a request gets.
  Error refusal(const auto& request) {
    client().send(request);
    return client().expect<Error>(patience);
  }
  Welcome greet(const std::string& with_token = token) {
    Hello hello;
    hello.protocol_version = protocol_version;
    hello.token = with_token;
    return ask_for<Welcome>(hello);
  }
  void greet_and_prepare() {
    serve();
    greet();
    ask_for<Ready>(Prepare{});
  }
  /// Rows that tie the first n points to nothing: g = v + u/dt of each.
  void tie_points(std::uint32_t n) {
    Tie tie;
    tie.mode = "gap";
    tie.slots = n;
    std::vector<std::int32_t> ptr, columns;
    for (std::uint32_t k = 0; k <= n; ++k) ptr.push_back(static_cast<std::int32_t>(k));
    for (std::uint32_t k = 0; k < n; ++k) columns.push_back(static_cast<std::int32_t>(k));
    tie.row_ptr = ptr;
    tie.columns = columns;
    tie.values = std::vector<double>(n, 1.0);
    ask_for<Ok>(tie);
  }
  void set_velocity(double x) {
    SetField set;
    set.field = "velocity";
    std::vector<double> values(3 * points);
    for (std::size_t i = 0; i < points; ++i) values[3 * i] = x;
    set.values = values;
    ask_for<Ok>(set);
  }
  static Run steps(std::uint64_t count, double dt = 0.1) {
    Run run;
    run.steps = count;
    run.dt = dt;
    return run;
  }
};

}  // namespace gabion::protocol
