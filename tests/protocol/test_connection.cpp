#include <catch2/catch.hpp>
#include <numeric>

#include "allocations.hpp"
#include "loopback.hpp"
#include "protocol/wire/connection.hpp"
#include "random_message.hpp"

using namespace gabion::protocol;
using namespace std::chrono_literals;

TEST_CASE("every message travels both ways") {
  Loopback link;
  RandomFields random(7);
  for_each_message([&]<class M>(M) {
    if (M::id == Error::id || M::id == Heartbeat::id) return;  // have their own meaning
    INFO(M::type_name);
    const M message = random.make<M>();
    link.client->send(message, 3);
    REQUIRE(link.server->expect<M>(1s) == message);
    link.server->send(message, 4);
    REQUIRE(link.client->expect<M>(1s) == message);
  });
  CHECK(link.client->bytes_sent() == link.server->bytes_received());
}

TEST_CASE("a payload larger than every buffer arrives whole") {
  Loopback link;
  State state;
  state.blob.resize({std::uint64_t{50} << 20});
  for (std::size_t i = 0; i < state.blob.size(); ++i) state.blob[i] = static_cast<std::uint8_t>(i * 31 >> 5);
  auto sending = std::async(std::launch::async, [&] { link.server->send(state); });
  CHECK(link.client->expect<State>(10s) == state);
  sending.get();
  link.server->send(Ok{});
  link.client->expect<Ok>(1s);
}

TEST_CASE("a wait ends at its deadline, and says who, what and at which step") {
  Loopback link;
  link.client->at_step(42);
  const double waited = seconds_of([&] { CHECK_THROWS_AS(link.client->expect<Gap>(150ms), Timeout); });
  CHECK(waited >= 0.15);
  CHECK(waited < 0.3);
  CHECK_THROWS_WITH(link.client->expect<Gap>(10ms),
                    Catch::StartsWith("engine at 127.0.0.1:") &&
                        Catch::EndsWith(": did not answer within 0.01 s (waiting for GAP, step 42)"));
}

TEST_CASE("half a frame does not hold a wait open") {
  RawPeer peer;
  const std::vector<std::byte> payload(100);
  const std::span<const std::byte> part(payload);
  const HeaderBytes header = encode_header({.type = Gap::id}, {&part, 1});
  peer.send(std::span(header).first(20));
  CHECK_THROWS_AS(peer.connection->receive(50ms, "GAP"), Timeout);
  peer.send(std::span(header).subspan(20));
  peer.send(part.first(99));
  CHECK_THROWS_AS(peer.connection->receive(50ms, "GAP"), Timeout);
  peer.send(part.first(1));
  CHECK(peer.connection->receive(1s, "GAP").payload.size() == 100);
}

TEST_CASE("a frame that is missing or comes twice is found by its number") {
  RawPeer peer;
  const HeaderBytes first = encode_header({.type = Ok::id, .sequence = 0}, {});
  peer.send(first);
  peer.send(first);
  peer.connection->expect<Ok>(1s);
  CHECK_THROWS_WITH(peer.connection->expect<Ok>(1s), Catch::Contains("frame number 0 came where 1 is due"));
}

TEST_CASE("bytes of another protocol are refused, however few") {
  RawPeer peer;
  const std::string text = "GET / HTTP/1.1\r\n";
  peer.send(std::as_bytes(std::span(text)));
  CHECK_THROWS_AS(peer.connection->receive(1s, "HELLO"), ProtocolError);
}

TEST_CASE("a closed connection is found at once, on either side and in either direction") {
  Loopback link;
  link.server.reset();
  const double waited = seconds_of([&] { CHECK_THROWS_AS(link.client->expect<Ok>(10s), ConnectionLost); });
  CHECK(waited < 0.1);
  CHECK_THROWS_AS(
      [&] {
        for (int i = 0; i < 100; ++i) link.client->send(Ok{});  // would raise SIGPIPE if that were not masked
      }(),
      ConnectionLost);
}

TEST_CASE("a peer that takes nothing is found when the send deadline passes") {
  Loopback link({.send_timeout = 100ms});
  State state;
  state.blob.resize({std::uint64_t{64} << 20});
  const double waited = seconds_of([&] { CHECK_THROWS_AS(link.client->send(state), Timeout); });
  CHECK(waited < 2.0);
}

TEST_CASE("heartbeats keep a wait alive, up to the longest wait") {
  Loopback link({.longest_wait = 600ms});
  std::vector<std::uint64_t> steps;
  link.client->on_heartbeat = [&](const Heartbeat& heartbeat) { steps.push_back(heartbeat.step); };
  auto server = std::async(std::launch::async, [&] {
    Heartbeat heartbeat;
    for (heartbeat.step = 0; heartbeat.step < 4; ++heartbeat.step) {
      std::this_thread::sleep_for(60ms);
      link.server->send(heartbeat);
    }
    link.server->send(Ok{});
  });
  link.client->expect<Ok>(100ms);
  server.get();
  CHECK(steps == std::vector<std::uint64_t>{0, 1, 2, 3});

  std::atomic<bool> done = false;
  server = std::async(std::launch::async, [&] {
    while (!done) {
      link.server->send(Heartbeat{});
      std::this_thread::sleep_for(20ms);
    }
  });
  const double waited = seconds_of([&] { CHECK_THROWS_AS(link.client->expect<Ok>(300ms), Timeout); });
  done = true;
  server.get();
  CHECK(waited >= 0.6);
  CHECK(waited < 0.9);
}

TEST_CASE("an ERROR becomes an exception with all it says") {
  Loopback link;
  Error error;
  error.code = "physics";
  error.message = "element 5 is inside out";
  error.where = "element 5";
  error.advice = "take a smaller step";
  error.step = 17;
  link.server->send(error);
  try {
    link.client->expect<Ok>(1s);
    FAIL("no exception");
  } catch (const RemoteError& caught) {
    CHECK(caught.code == "physics");
    CHECK(caught.where == "element 5");
    CHECK(caught.step == 17);
    CHECK_THAT(caught.what(), Catch::EndsWith("physics error: element 5 is inside out [element 5]; take a smaller step "
                                              "(waiting for OK, step 17)"));
  }
}

TEST_CASE("another message than the one that is due is refused, and the connection goes on") {
  Loopback link;
  link.server->send(Welcome{});
  link.server->send(Ok{});
  CHECK_THROWS_AS(link.client->expect<Gap>(1s), UnexpectedMessage);
  CHECK_NOTHROW(link.client->expect<Ok>(1s));
}

TEST_CASE("a frame above the payload limit is refused before its payload is read") {
  Loopback link;
  link.client->set_payload_limit(100);
  State state;
  state.blob.resize({101});
  link.server->send(state);
  CHECK_THROWS_AS(link.client->expect<State>(1s), ProtocolError);
}

TEST_CASE("a step's exchange carries its rows, and allocates nothing") {
  Loopback link;
  std::vector<double> sent(900), received(900);
  std::iota(sent.begin(), sent.end(), 0.5);
  const auto exchange = [&](std::uint64_t step) {
    link.server->send_gap(sent, step);
    link.client->receive_gap(received, step, 1s);
    link.client->send_multipliers(received, step == 9, step);
    return link.server->receive_multipliers(received, step, 1s);
  };
  CHECK_FALSE(exchange(0));
  CHECK(received == sent);
  const std::size_t before = allocation_count();
  bool last = false;
  for (std::uint64_t step = 1; step < 10; ++step) last = exchange(step);
  CHECK(allocation_count() == before);
  CHECK(last);
}

TEST_CASE("kept messages are received without allocation") {
  Loopback link;
  Gap sent, received;
  sent.values = std::vector<double>(900, 1.5);
  link.server->send(sent, 0);
  link.client->expect(received, 1s);
  const std::size_t before = allocation_count();
  for (std::uint64_t step = 1; step < 10; ++step) {
    link.server->send(sent, step);
    link.client->expect(received, 1s);
  }
  CHECK(allocation_count() == before);
  CHECK(received == sent);
}

TEST_CASE("rows and messages are the same bytes") {
  Loopback link;
  Gap gap;
  gap.values = std::vector<double>{1, 2, 3, 4, 5, 6};
  link.server->send_gap(gap.values.data, 1);
  CHECK(link.client->expect<Gap>(1s) == gap);
  Multipliers multipliers;
  multipliers.stop = 1;
  multipliers.values = gap.values;
  link.server->send_multipliers(gap.values.data, true, 2);
  CHECK(link.client->expect<Multipliers>(1s) == multipliers);
}

TEST_CASE("rows of another step or another size are refused") {
  Loopback link;
  std::vector<double> rows(6);
  link.server->send_gap(rows, 4);
  CHECK_THROWS_WITH(link.client->receive_gap(rows, 5, 1s),
                    Catch::Contains("GAP of step 4 came where that of step 5 is due"));
  link.server->send_gap(rows, 5);
  std::vector<double> fewer(3);
  CHECK_THROWS_AS(link.client->receive_gap(fewer, 5, 1s), BadMessage);
  Ready ready;
  link.server->send(ready, 5);
  CHECK_THROWS_AS(link.client->receive_gap(rows, 5, 1s), UnexpectedMessage);
}
