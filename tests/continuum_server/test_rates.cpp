// Elements of several rates: against one rate, against the scheme written out plainly, state, refusals.

#include "rates_fixture.hpp"

using namespace gabion::continuum;
namespace engine = gabion::engine;
using engine::RequestError;
using engine::vec;

namespace {

std::string refused(const std::function<void()>& action) {
  try {
    action();
  } catch (const RequestError& error) {
    return error.where + ": " + error.what();
  }
  FAIL("nothing was refused");
  return "";
}

}  // namespace

TEST_CASE("rates of 1 are no rates, bit for bit") {
  std::uint64_t hash[2];
  for (const bool ones : {false, true}) {
    Solid solid(Bar(12, 2, 2, 2, 8, 0.1).mesh, soil);
    solid.engine.options.gravity = vec(0, 0, -9.81);
    solid.engine.prepare();
    const double stable = solid.engine.stable_step();
    if (ones) solid.engine.set_rates(Bytes(solid.engine.mesh().elements.size(), 1));
    CHECK(solid.engine.stable_step() == stable);
    CHECK(solid.engine.period() == 1);
    solid.set_noise(solid.engine.motion.velocity, 1e-2);
    solid.run(50, 0.9 * stable);
    hash[ones] = solid.engine.state_hash();
  }
  CHECK(hash[0] == hash[1]);
}

TEST_CASE("one rate r everywhere is a leapfrog with r dt, bit for bit") {
  constexpr double dt = 0x1p-9;
  constexpr int rate = 4;
  std::uint64_t hash[2];
  double balance[2];
  for (const bool coarse : {false, true}) {
    Solid solid(box_mesh({4, 3, 3}, vec(4, 3, 3)), soil);
    const auto head = solid.nodes([](Vec x) { return x[0] == 4.0; }), side = solid.nodes([](Vec x) { return x[1] == 0.0; });
    solid.engine.boundary.add(engine::Constraint{"head", head, 1, vec(1, 0, 0), {"half_sine", {0.1, 0.0, 1.0}}}, solid.engine.motion.size());
    solid.engine.boundary.add(engine::Dashpot{"side", side, VecField(side.size(), vec(1e3, 1e3, 1e3))}, solid.engine.motion.size());
    solid.engine.prepare();
    const double stable = solid.engine.stable_step();
    REQUIRE(rate * dt < 0.9 * stable);
    solid.set_noise(solid.engine.motion.velocity, 1e-2);
    if (coarse) {
      solid.engine.set_rates(Bytes(solid.engine.mesh().elements.size(), rate));
      CHECK(solid.engine.stable_step() == Approx(stable / rate).epsilon(1e-6));
      balance[coarse] = run_at_rates(solid, 60 * rate, dt).balance();
    } else {
      solid.run(60, rate * dt);
      balance[coarse] = solid.engine.ledger().balance();
    }
    hash[coarse] = solid.engine.state_hash();
  }
  CHECK(hash[0] == hash[1]);
  CHECK(balance[0] == balance[1]);
}

/// u and V of all nodes moved in every fine step, elements giving r_e dt F_e at multiples of r_e: the scheme as it is stated.
TEST_CASE("a step at rates is the stated scheme") {
  const Bar bar(12, 2, 2, 3, 8, 0.1);
  Solid solid(bar.mesh, soil);
  solid.engine.options.gravity = vec(1, 2, -9.81);
  const auto side = solid.nodes([](Vec x) { return x[1] == 0.0; });
  solid.engine.boundary.add(engine::Load{"side", side, VecField(side.size(), vec(10, 0, -100)), {"constant", {1.0}}}, solid.engine.motion.size());
  solid.engine.prepare();
  const double dt = 0.9 * solid.engine.stable_step() / 8;
  solid.engine.set_rates(bar.rate);
  solid.set_noise(solid.engine.motion.velocity, 1e-2);
  VecField u = solid.engine.motion.displacement, v = solid.engine.motion.velocity;

  std::vector<ElementStiffness> stiffness;
  for (std::size_t e = 0; e < bar.rate.size(); ++e) stiffness.push_back(solid.engine.element_stiffness(e));
  std::vector<int> node_rate(u.size(), 128);
  for (std::size_t e = 0; e < bar.rate.size(); ++e)
    for (const std::int32_t n : bar.mesh.elements[e]) node_rate[n] = std::min<int>(node_rate[n], bar.rate[e]);
  VecField outer(u.size());
  for (std::size_t n = 0; n < u.size(); ++n) outer[n] = engine::splat(solid.engine.motion.mass[n]) * solid.engine.options.gravity;
  // the body load of a distorted element is consistent, not lumped with the mass: take the engine's
  Solid still(bar.mesh, soil);
  still.engine.options.gravity = solid.engine.options.gravity;
  still.engine.prepare();
  still.run(1, 1e-9);
  outer = still.engine.motion.force;
  for (const std::int32_t n : side) outer[n] += vec(10, 0, -100);

  constexpr int steps = 80;
  for (int k = 0; k < steps; ++k) {
    VecField impulse(u.size(), Vec{});
    for (std::size_t e = 0; e < bar.rate.size(); ++e) {
      if (k % bar.rate[e] != 0) continue;
      const auto& nodes = bar.mesh.elements[e];
      for (int row = 0; row < 24; ++row)
        for (int column = 0; column < 24; ++column)
          impulse[nodes[row / 3]][row % 3] -= bar.rate[e] * dt * stiffness[e][24 * row + column] * u[nodes[column / 3]][column % 3];
    }
    for (std::size_t n = 0; n < u.size(); ++n) {
      if (k % node_rate[n] == 0) impulse[n] += engine::splat(node_rate[n] * dt) * outer[n];
      v[n] += impulse[n] / engine::splat(solid.engine.motion.mass[n]);
      u[n] += engine::splat(dt) * v[n];
    }
  }
  run_at_rates(solid, steps, dt);
  double largest = 0.0, difference = 0.0;
  for (std::size_t n = 0; n < u.size(); ++n) {
    largest = std::max(largest, engine::norm(u[n]));
    difference = std::max(difference, engine::norm(u[n] - solid.engine.motion.displacement[n]));
  }
  CHECK(difference < 1e-12 * largest);
}

TEST_CASE("beyond the limit of the coarsest elements the energy grows") {
  const Bar bar(32, 3, 2, 4, 8);
  Solid solid(bar.mesh, soil);
  solid.engine.prepare();
  solid.engine.set_rates(bar.rate);
  const double dt = 1.03 * solid.engine.stable_step();
  solid.set_noise(solid.engine.motion.velocity, 1e-3);
  CHECK_THROWS_AS(run_at_rates(solid, 4000, dt), engine::PhysicsError);
  CHECK_FALSE(solid.engine.motion.largest_speed() < 1.0);  // from 1e-3
}

TEST_CASE("momentum is kept at several rates") {
  const Bar bar(20, 3, 2, 3, 8, 0.1);
  Solid solid(bar.mesh, soil);
  solid.engine.prepare();
  solid.engine.set_rates(bar.rate);
  solid.set_noise(solid.engine.motion.velocity, 1e-3);
  const auto before = solid.engine.momentum();
  run_at_rates(solid, 800, 0.9 * solid.engine.stable_step());
  const auto after = solid.engine.momentum();
  for (int axis = 0; axis < 3; ++axis) CHECK(std::fabs(after[axis] - before[axis]) < 1e-13 * after[6]);
}

TEST_CASE("a restored engine changes its rates as the unbroken one does, under a load that grows") {
  const Bar bar(24, 2, 2, 3, 8);
  const auto set_up = [&](Solid& one) {
    const auto end = one.nodes([](Vec x) { return x[0] == 24.0; });
    one.engine.boundary.add(engine::Load{"end", end, VecField(end.size(), vec(5, 0, 2)), {"ramp", {1.0, 0.0, 1.0}}}, one.engine.motion.size());
    one.engine.prepare();
    one.engine.set_rates(bar.rate);
  };
  Solid solid(bar.mesh, soil);
  set_up(solid);
  const double dt = 0.8 * solid.engine.stable_step();
  run_at_rates(solid, 160, dt);
  const auto state = solid.engine.checkpoint();
  const auto hash_at_one_rate = [&](Solid& one) {
    one.engine.set_rates(Bytes(bar.rate.size(), 1));
    run_at_rates(one, 5, dt, 160);
    return one.engine.state_hash();
  };
  Solid restored(bar.mesh, soil);
  set_up(restored);
  restored.engine.restore(state);
  CHECK(hash_at_one_rate(restored) == hash_at_one_rate(solid));
}

TEST_CASE("one, two and three threads give the same state at several rates") {
  const Bar bar(20, 4, 2, 3, 8, 0.1);
  std::vector<std::uint64_t> hashes;
  for (const int threads : {1, 2, 3}) {
    Solid solid(bar.mesh, soil);
    solid.engine.threads = threads;
    solid.engine.options.gravity = vec(0, 0, -9.81);
    solid.engine.prepare();
    solid.engine.set_rates(bar.rate);
    solid.set_noise(solid.engine.motion.velocity, 1e-2);
    run_at_rates(solid, 80, 0.9 * solid.engine.stable_step());
    hashes.push_back(solid.engine.state_hash());
  }
  CHECK(hashes[1] == hashes[0]);
  CHECK(hashes[2] == hashes[0]);
}

TEST_CASE("a restored state goes on bit for bit at several rates") {
  const Bar bar(16, 3, 2, 3, 8);
  const auto set_up = [&](Solid& solid) {
    solid.engine.options.gravity = vec(0, 0, -9.81);
    const auto far = solid.nodes([](Vec x) { return x[0] == 16.0; });
    solid.engine.boundary.add(engine::Dashpot{"far", far, VecField(far.size(), vec(1e4, 1e4, 1e4))}, solid.engine.motion.size());
    solid.engine.prepare();
    solid.engine.set_rates(bar.rate);
  };
  Solid unbroken(bar.mesh, soil), resumed(bar.mesh, soil);
  set_up(unbroken);
  const double dt = 0.8 * unbroken.engine.stable_step();
  run_at_rates(unbroken, 80, dt);
  set_up(resumed);
  resumed.engine.restore(unbroken.engine.checkpoint());
  CHECK(run_at_rates(unbroken, 160, dt, 80).balance() == run_at_rates(resumed, 160, dt, 80).balance());
  CHECK(unbroken.engine.state_hash() == resumed.engine.state_hash());
}

TEST_CASE("rates that make no sense are refused") {
  const Bar bar(16, 2, 4, 3, 8);
  Solid solid(bar.mesh, soil);
  CHECK(refused([&] { solid.engine.set_rates(bar.rate); }).find("PREPARE") == std::string::npos);  // says what, advises PREPARE
  solid.engine.prepare();
  CHECK(refused([&] { solid.engine.set_rates(Bytes(3, 1)); }).find("3 rates for 64 elements") != std::string::npos);
  Bytes wrong = bar.rate;
  wrong[7] = 3;
  CHECK(refused([&] { solid.engine.set_rates(wrong); }).find("element 7 has the rate 3") != std::string::npos);
  wrong = bar.rate;
  std::reverse(wrong.begin(), wrong.end());
  CHECK(refused([&] { solid.engine.set_rates(wrong); }).find("smaller rates") != std::string::npos);
  CHECK(solid.engine.period() == 1);

  // tied: the lowest four nodes of a column; their element, and one layer more, must take every step
  const auto tie = [](Solid& s, std::int32_t nodes) {
    std::vector<std::int32_t> columns;
    for (std::int32_t n = 0; n < nodes; ++n) columns.push_back(n);
    s.engine.tie.set(engine::Tie::Mode::gap, 1, {}, {0, nodes}, columns, std::vector<double>(columns.size(), 1.0), s.engine.motion);
  };
  for (const int fine : {1, 2}) {
    CAPTURE(fine);
    const Bytes rate = graded_rates(16, 1, fine, 3, 8);
    Solid s(box_mesh({1, 1, 16}, vec(1, 1, 16)), soil), late(box_mesh({1, 1, 16}, vec(1, 1, 16)), soil);
    s.engine.prepare();
    tie(s, 4);
    late.engine.prepare();
    late.engine.set_rates(rate);
    tie(late, 4);
    if (fine < 2) {
      CHECK(refused([&] { s.engine.set_rates(rate); }).find("is tied") != std::string::npos);
      CHECK(refused([&] { late.run(1, 1e-6); }).find("is tied") != std::string::npos);
    } else {
      s.engine.set_rates(rate);
      CHECK(s.engine.period() == 8);
    }
  }
}
