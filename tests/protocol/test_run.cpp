// RUN with a tie: the exchange of each step, and what may go wrong in it.
#include <catch2/catch.hpp>

#include "session_fixture.hpp"

using namespace gabion::protocol;
using namespace std::chrono_literals;

namespace {

constexpr std::uint32_t rows = 3;

/// Answers each GAP with multipliers that stop the tied points: mu = gap.
void answer(Connection& client, std::uint64_t step, bool last = false) {
  std::vector<double> gap(3 * rows);
  client.receive_gap(gap, step, 5s);
  client.send_multipliers(gap, last, step);
}

Session& tied(Session& session) {
  session.greet_and_prepare();
  session.tie_points(rows);
  session.set_velocity(1.0);
  return session;
}

}  // namespace

TEST_CASE("tied points stand still, the others move") {
  Session session;
  tied(session);
  session.client().send(Session::steps(20));
  for (std::uint64_t step = 0; step < 20; ++step) answer(session.client(), step);
  CHECK(session.client().expect<RunDone>(5s).step == 20);
  Fetch fetch;
  fetch.field = "displacement";
  const Field u = session.ask_for<Field>(fetch);
  CHECK(std::abs(u.values.row(0)[0]) < 1e-14);
  CHECK(u.values.row(rows)[0] == Approx(std::sin(2.0)).epsilon(0.1));
}

TEST_CASE("the stop flag ends a run after its step") {
  Session session;
  tied(session);
  session.client().send(Session::steps(1000));
  for (std::uint64_t step = 0; step < 5; ++step) answer(session.client(), step, step == 4);
  CHECK(session.client().expect<RunDone>(5s).step == 5);
}

TEST_CASE("a value that is not finite is not sent to the other engine") {
  Session session;
  tied(session);
  session.client().send(Session::steps(10));
  answer(session.client(), 0);
  std::vector<double> gap(3 * rows);
  session.client().receive_gap(gap, 1, 5s);
  gap[4] = std::nan("");
  session.client().send_multipliers(gap, false, 1);
  const Error error = session.client().expect<Error>(5s);
  CHECK(error.code == "physics");
  CHECK(error.where == "MULTIPLIERS row 1");
  CHECK(error.step == 1);
}

TEST_CASE("a velocity that is not finite never leaves as a gap") {
  Session session;
  session.greet_and_prepare();
  session.tie_points(rows);
  session.engine.motion.velocity[2][1] = INFINITY;
  const Error error = session.refusal(Session::steps(10));
  CHECK(error.code == "physics");
  CHECK(error.where == "GAP row 2");
  CHECK_THAT(error.message, Catch::Contains("component y is inf"));
}

TEST_CASE("trouble in the physics ends the run with its step; a state must be restored before the next") {
  Session session;
  tied(session);
  Restore restore;
  restore.blob = session.ask_for<State>(Checkpoint{}).blob;
  session.engine.throw_at = 2;
  session.client().send(Session::steps(10));
  for (std::uint64_t step = 0; step < 2; ++step) answer(session.client(), step);
  const Error error = session.client().expect<Error>(5s);
  CHECK(error.code == "physics");
  CHECK(error.where == "point 3");
  CHECK(error.step == 2);
  session.engine.throw_at = UINT64_MAX;
  CHECK_THAT(session.refusal(Session::steps(1)).advice, Catch::Contains("RESTORE"));
  session.ask_for<Ok>(restore);
  session.client().send(Session::steps(1));
  answer(session.client(), 0);
  session.client().expect<RunDone>(5s);
}

TEST_CASE("an answer that crosses the engine's error is no request") {
  Session session;
  tied(session);
  session.engine.throw_after_gap = 1;
  session.client().send(Session::steps(10));
  answer(session.client(), 0);
  answer(session.client(), 1);  // the engine fails without waiting for this
  CHECK(session.client().expect<Error>(5s).where == "point 4");
  session.ask_for<Ready>(StableStep{});
}

TEST_CASE("another message than MULTIPLIERS ends the run, not the session") {
  Session session;
  tied(session);
  session.client().send(Session::steps(10));
  session.client().expect<Gap>(5s);
  CHECK(session.refusal(Checkpoint{}).code == "state");
  session.ask_for<Ready>(StableStep{});
}

TEST_CASE("multipliers of another size or step end the run, not the session") {
  for (const std::uint64_t step : {std::uint64_t{0}, std::uint64_t{1}}) {
    Session session;
    tied(session);
    session.client().send(Session::steps(10));
    session.client().expect<Gap>(5s);
    const std::vector<double> wrong(step == 0 ? 3 * rows + 3 : 3 * rows);
    session.client().send_multipliers(wrong, false, step);
    CHECK(session.client().expect<Error>(5s).code == "value");
    session.ask_for<Ready>(StableStep{});
  }
}

TEST_CASE("an ERROR from the client ends the run without an answer") {
  Session session;
  tied(session);
  session.client().send(Session::steps(10));
  session.client().expect<Gap>(5s);
  Error error;
  error.code = "internal";
  error.message = "the other engine has failed";
  session.client().send(error);
  session.ask_for<Ready>(StableStep{});
}

TEST_CASE("a coupler that freezes is found at the exchange deadline, with its name and the step") {
  Session session;
  session.options.exchange_timeout = 200ms;
  tied(session);
  session.client().send(Session::steps(10));
  answer(session.client(), 0);
  session.client().expect<Gap>(5s);
  const double waited = seconds_of([&] { CHECK(session.outcome.wait_for(5s) == std::future_status::ready); });
  CHECK(waited >= 0.15);
  CHECK(waited < 0.4);
  CHECK(session.client().expect<Error>(1s).code == "timeout");
  CHECK_THROWS_WITH(session.outcome.get(),
                    Catch::StartsWith("coupler at 127.0.0.1:") &&
                        Catch::EndsWith("did not answer within 0.2 s (waiting for MULTIPLIERS, step 1)"));
}

TEST_CASE("a coupler that dies in a run is found at once") {
  Session session;
  tied(session);
  session.client().send(Session::steps(10));
  session.client().expect<Gap>(5s);
  const double waited = seconds_of([&] {
    session.client().close();
    CHECK_THROWS_AS(session.outcome.get(), ConnectionLost);
  });
  CHECK(waited < 0.2);
}

TEST_CASE("heartbeats come while a request takes long, and not between requests") {
  Session session;
  session.options.heartbeat_period = 50ms;
  session.engine.slowness = 220ms;
  std::vector<std::string> phases;
  session.client().on_heartbeat = [&](const Heartbeat& heartbeat) { phases.push_back(heartbeat.phase); };
  session.greet_and_prepare();
  CHECK(phases.size() >= 3);
  CHECK(phases.size() <= 4);
  for (const std::string& phase : phases) CHECK(phase == "PREPARE");
  CHECK_THROWS_AS(session.client().receive(200ms, "nothing"), Timeout);

  phases.clear();
  session.tie_points(rows);
  session.client().send(Session::steps(1));
  answer(session.client(), 0);
  session.client().expect<RunDone>(100ms);  // kept alive by heartbeats
  CHECK(phases.size() >= 3);
  CHECK(phases.front() == "RUN");
}

TEST_CASE("a long run without a tie ends when its client has gone") {
  Session session;
  session.options.heartbeat_period = 20ms;
  session.greet_and_prepare();
  session.client().send(Session::steps(std::uint64_t{1} << 60));
  std::this_thread::sleep_for(100ms);
  session.client().close();
  REQUIRE(session.outcome.wait_for(5s) == std::future_status::ready);
  CHECK_THROWS_AS(session.outcome.get(), ConnectionLost);
}
