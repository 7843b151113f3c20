#include <catch2/catch.hpp>

#include "protocol/session/service.hpp"
#include "session_fixture.hpp"

using namespace gabion::protocol;
using namespace std::chrono_literals;

namespace {

/// A FETCH whose payload ends too early.
struct Malformed {
  static constexpr std::uint16_t id = Fetch::id;
  void encode(Writer& writer) const { writer.put(std::uint8_t{1}); }
};

struct MalformedHeartbeat {
  static constexpr std::uint16_t id = Heartbeat::id;
  void encode(Writer& writer) const { writer.put(std::uint8_t{1}); }
};

}  // namespace

TEST_CASE("a client with the token is welcomed, served and let go") {
  Session session;
  session.serve();
  const Welcome welcome = session.greet();
  CHECK(welcome.protocol_version == protocol_version);
  CHECK(welcome.role == "dem");
  CHECK(welcome.capabilities == std::vector<std::string>{"field:displacement"});
  const Ready ready = session.ask_for<Ready>(Prepare{});
  CHECK(ready.mass.data == std::vector<double>(Session::points, 1.0));
  CHECK(ready.stable_step == 2.0);
  CHECK(ready.highest_frequency == 1.0);
  session.ask_for<Ok>(Bye{});
  CHECK(session.outcome.get() == Service::Outcome::finished);
  CHECK_THROWS_AS(session.client().receive(1s, "the end"), ConnectionLost);
}

TEST_CASE("a wrong token is refused and the connection closed") {
  for (const std::string token : {"", "c", "correct horsf", "correct horse ", "correct hors"}) {
    Session session;
    session.serve();
    try {
      session.greet(token);
      FAIL("welcomed with '" + token + "'");
    } catch (const RemoteError& error) {
      CHECK(error.code == "token");
      CHECK_THAT(error.advice, Catch::Contains("GABION_TOKEN"));
    }
    CHECK(session.outcome.get() == Service::Outcome::refused);
    CHECK_THROWS_AS(session.client().receive(1s, "the end"), ConnectionLost);
  }
}

TEST_CASE("another version is refused") {
  Session session;
  session.serve();
  Hello hello;
  hello.protocol_version = 99;
  hello.token = Session::token;
  const Error error = session.refusal(hello);
  CHECK(error.code == "version");
  CHECK_THAT(error.message, Catch::Contains("99"));
  CHECK(session.outcome.get() == Service::Outcome::refused);
}

TEST_CASE("nothing is done before HELLO") {
  Session session;
  session.serve();
  CHECK(session.refusal(Prepare{}).code == "state");
  CHECK(session.outcome.get() == Service::Outcome::refused);
}

TEST_CASE("before HELLO no large frame is taken") {
  Session session;
  session.serve();
  Hello hello;
  hello.protocol_version = protocol_version;
  hello.token = Session::token;
  hello.software = std::string(100000, 'x');
  session.client().send(hello);
  CHECK(session.outcome.get() == Service::Outcome::refused);
}

TEST_CASE("a silent client does not hold the engine") {
  Session session;
  session.options.handshake_timeout = 100ms;
  session.serve();
  CHECK(session.outcome.wait_for(1s) == std::future_status::ready);
  CHECK(session.outcome.get() == Service::Outcome::refused);
}

TEST_CASE("a request in the wrong state is refused with both states, and the session goes on") {
  Session session;
  session.serve();
  session.greet();
  Error error = session.refusal(Session::steps(1));
  CHECK(error.code == "state");
  CHECK(error.message == "RUN is not allowed in the state configuring");
  CHECK(error.advice == "it is allowed in the state ready");
  CHECK(session.refusal(Hello{}).code == "state");
  session.ask_for<Ready>(Prepare{});
  CHECK(session.refusal(Multipliers{}).code == "state");
  CHECK(session.refusal(Mesh{}).code == "value");
  CHECK(session.refusal(Ready{}).code == "value");
  session.ask_for<Ok>(Bye{});
  CHECK(session.outcome.get() == Service::Outcome::finished);
}

TEST_CASE("a change of the set-up must be prepared before the next run") {
  Session session;
  session.greet_and_prepare();
  session.ask_for<RunDone>(Session::steps(1));
  session.ask_for<Ok>(Options{});
  CHECK(session.refusal(Session::steps(1)).message == "RUN is not allowed in the state configuring");
  session.ask_for<Ready>(Prepare{});
  session.ask_for<RunDone>(Session::steps(1));
}

TEST_CASE("values that make no sense are refused by name, and the session goes on") {
  Session session;
  session.greet_and_prepare();
  Constrain constrain;
  constrain.name = "floor";
  constrain.history_kind = "zero";
  constrain.entities = std::vector<std::int32_t>{0, 99};
  CHECK_THAT(session.refusal(constrain).message, Catch::Contains("99"));
  constrain.entities = std::vector<std::int32_t>{0};
  constrain.history_kind = "sawtooth";
  CHECK_THAT(session.refusal(constrain).message, Catch::Contains("sawtooth") && Catch::Contains("half_sine"));
  for (const double dt : {0.0, -1.0, std::nan(""), double{INFINITY}}) {
    const Error error = session.refusal(Session::steps(1, dt));
    CHECK(error.code == "value");
    CHECK(error.where == "RUN.dt");
  }
  CHECK(session.refusal(Session::steps(0)).where == "RUN.steps");
  Run damped = Session::steps(1);
  damped.damping = 1.0;
  CHECK(session.refusal(damped).where == "RUN.damping");
  Fetch fetch;
  fetch.field = "colour";
  CHECK(session.refusal(fetch).advice == "known: displacement");
  Tie tie;
  tie.mode = "knot";
  CHECK_THAT(session.refusal(tie).message, Catch::Contains("knot"));
  Probes probes;
  probes.names = {"a"};
  CHECK(session.refusal(probes).code == "value");
  session.ask_for<RunDone>(Session::steps(1));
}

TEST_CASE("a payload that does not decode is refused, and the session goes on") {
  Session session;
  session.greet_and_prepare();
  const Error error = session.refusal(Malformed{});
  CHECK(error.code == "value");
  CHECK(error.message == "FETCH.field: 4 bytes are due, 1 are left");
  session.ask_for<RunDone>(Session::steps(1));
}

TEST_CASE("loads, constraints and probes act in a run") {
  Session session;
  session.greet_and_prepare();
  Loads loads;
  loads.name = "push";
  loads.entities = std::vector<std::int32_t>{1};
  loads.vectors = std::vector<double>{2, 0, 0};
  loads.history_kind = "constant";
  loads.history = std::vector<double>{1};
  session.ask_for<Ok>(loads);
  Constrain constrain;
  constrain.name = "move";
  constrain.entities = std::vector<std::int32_t>{2};
  constrain.components = 2;
  constrain.direction = std::vector<double>{0, 3, 0};
  constrain.history_kind = "constant";
  constrain.history = std::vector<double>{1};
  session.ask_for<Ok>(constrain);
  Probes probes;
  probes.names = {"pushed", "moved"};
  probes.row_ptr = std::vector<std::int32_t>{0, 1, 2};
  probes.entities = std::vector<std::int32_t>{1, 2};
  probes.coefficients = std::vector<double>{1, 1};
  probes.every = 2;
  session.ask_for<Ok>(probes);
  Run run = Session::steps(5);
  run.first_step = 10;
  run.time = 1.0;
  const RunDone done = session.ask_for<RunDone>(run);
  CHECK(done.step == 15);
  CHECK(done.time == Approx(1.5));
  CHECK(done.probe_steps.data == std::vector<double>{10, 12, 14});
  CHECK(done.probes.extents()[1] == 2);
  CHECK(done.probes[6 * 2 + 3 + 1] == Approx(4 * 0.1 * 3));  // moved, y, at step 14
  CHECK(done.probes[6] > 0.0);                               // pushed, x, at step 12
  CHECK(done.reaction_names == std::vector<std::string>{"move"});
  CHECK(done.reactions.rows() == 1);
  CHECK(done.counters.data == std::vector<double>{8.0});
  CHECK(done.ledger.empty());
  CHECK(session.ask_for<RunDone>(run).probe_steps.size() == 3);  // those of the first run are gone
}

TEST_CASE("the ledger is measured in the last step, when it is kept") {
  Session session;
  session.serve();
  session.greet();
  Options options;
  options.measure_energy = 1;
  session.ask_for<Ok>(options);
  session.ask_for<Ready>(Prepare{});
  session.set_velocity(2.0);
  Run run = Session::steps(1, 1e-6);
  run.measure = 1;
  const RunDone done = session.ask_for<RunDone>(run);
  CHECK(done.ledger_names == std::vector<std::string>{"kinetic", "loads"});
  CHECK(done.ledger[0] == Approx(0.5 * 8 * 4));
  CHECK(done.ledger_kinds.data == std::vector<std::uint8_t>{0, 2});
  CHECK(done.momentum[0] == Approx(8 * 2.0));
}

TEST_CASE("a checkpoint is restored bit for bit") {
  Session session;
  session.greet_and_prepare();
  session.set_velocity(1.0);
  session.ask_for<RunDone>(Session::steps(7));
  Restore restore;
  restore.blob = session.ask_for<State>(Checkpoint{}).blob;
  const std::uint64_t hash = session.ask_for<RunDone>(Session::steps(9)).state_hash;
  session.ask_for<RunDone>(Session::steps(3));
  session.ask_for<Ok>(restore);
  CHECK(session.ask_for<RunDone>(Session::steps(9)).state_hash == hash);
}

TEST_CASE("a client that does not ask for anything is let go at the idle deadline") {
  Session session;
  session.options.idle_timeout = 100ms;
  session.greet_and_prepare();
  CHECK(session.client().expect<Error>(1s).code == "timeout");
  CHECK_THROWS_AS(session.outcome.get(), Timeout);
}

TEST_CASE("a client that sends heartbeats is let go when they cease, not before") {
  Session session;
  session.options.exchange_timeout = 300ms;
  session.greet_and_prepare();
  Heartbeat heartbeat;
  heartbeat.phase = "writing results";
  for (int beat = 0; beat < 8; ++beat) {
    session.client().send(heartbeat);
    std::this_thread::sleep_for(100ms);
  }
  session.ask_for<RunDone>(Session::steps(3));
  const double waited = seconds_of([&] {
    const Error error = session.client().expect<Error>(2s);
    CHECK(error.code == "timeout");
    CHECK_THAT(error.message, Catch::Contains("'writing results'") && Catch::Contains("step 3"));
  });
  CHECK(waited > 0.2);
  CHECK(waited < 1.0);
  CHECK_THROWS_AS(session.outcome.get(), Timeout);
}

TEST_CASE("a client that sends no heartbeats has the idle deadline, however short that of a step") {
  Session session;
  session.options.exchange_timeout = 50ms;
  session.greet_and_prepare();
  std::this_thread::sleep_for(300ms);
  session.ask_for<RunDone>(Session::steps(3));
}

TEST_CASE("a heartbeat that does not decode ends the session") {
  Session session;
  session.greet_and_prepare();
  session.client().send(MalformedHeartbeat{});
  CHECK_THROWS_AS(session.outcome.get(), BadMessage);
}

TEST_CASE("a client that vanishes is found at once") {
  Session session;
  session.greet_and_prepare();
  const double waited = seconds_of([&] {
    session.client().close();
    CHECK_THROWS_AS(session.outcome.get(), ConnectionLost);
  });
  CHECK(waited < 0.5);
}
