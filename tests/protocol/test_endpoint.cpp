#include <catch2/catch.hpp>

#include "loopback.hpp"

using namespace gabion::protocol;
using namespace std::chrono_literals;

TEST_CASE("a taken port is refused with the address and what to do") {
  Listener first({"127.0.0.1", 0});
  const Address taken = first.address();
  CHECK(taken.port != 0);
  CHECK_THROWS_AS(Listener(taken), AddressError);
  CHECK_THROWS_WITH(Listener(taken), Catch::StartsWith("cannot listen on 127.0.0.1:" + std::to_string(taken.port)) &&
                                         Catch::EndsWith("; choose another port, or 0 for a free one"));
}

TEST_CASE("connecting tries again until somebody listens") {
  std::uint16_t port;
  { port = Listener({"127.0.0.1", 0}).address().port; }
  auto listening = std::async(std::launch::async, [&] {
    std::this_thread::sleep_for(100ms);
    Listener listener({"127.0.0.1", port});
    return listener.accept(2s, "coupler");
  });
  Connection client = Connection::connect("127.0.0.1", port, 2s, "dem engine");
  Connection server = listening.get();
  client.send(Ok{});
  server.expect<Ok>(1s);
}

TEST_CASE("connecting to nobody ends at the deadline and names the engine") {
  std::uint16_t port;
  { port = Listener({"127.0.0.1", 0}).address().port; }
  const double waited = seconds_of([&] {
    CHECK_THROWS_WITH(Connection::connect("127.0.0.1", port, 200ms, "dem engine"),
                      Catch::StartsWith("dem engine at 127.0.0.1:" + std::to_string(port) + ": cannot be reached"));
  });
  CHECK(waited < 0.4);
}

TEST_CASE("waiting for a client ends at the deadline") {
  Listener listener({"127.0.0.1", 0});
  const double waited = seconds_of([&] { CHECK_THROWS_AS(listener.accept(100ms, "coupler"), Timeout); });
  CHECK(waited >= 0.1);
  CHECK(waited < 0.3);
}

TEST_CASE("addresses are read, and mistakes in them named") {
  CHECK(parse_address("127.0.0.1:80").port == 80);
  CHECK(parse_address("localhost:0").host == "localhost");
  CHECK(parse_address("[::1]:7").host == "::1");
  for (const char* wrong : {"", "127.0.0.1", ":80", "host:", "host:x", "host:70000", "host:80x", "[::1:7"})
    CHECK_THROWS_AS(parse_address(wrong), AddressError);
}
