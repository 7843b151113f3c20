// Elements of several rates: against one rate, against the scheme written out plainly, energy, refusals.

#include <catch2/catch.hpp>

#include "solid_fixture.hpp"

using namespace gabion::continuum;
namespace engine = gabion::engine;
using engine::RequestError;
using engine::vec;
using Bytes = std::vector<std::uint8_t>;

namespace {

const SolidMaterial soil = isotropic(1e6, 0.3, 1000.0);

/// Rates along x: 1 for the first `fine` elements, then `layers` each of 2, 4 ... up to the largest.
Bytes graded_rates(int nx, int others, int fine, int layers, int largest) {
  Bytes rate;
  for (int e = 0; e < nx * others; ++e) {
    const int x = e % nx;
    rate.push_back(static_cast<std::uint8_t>(x < fine ? 1 : std::min(largest, 2 << ((x - fine) / layers))));
  }
  return rate;
}

/// A bar with some distorted elements, its nodes numbered for the rates.
struct Bar {
  Bytes rate;
  Mesh mesh;
  Bar(int nx, int side, int fine, int layers, int largest, double distortion = 0.0)
      : rate(graded_rates(nx, side * side, fine, layers, largest)), mesh(box_mesh({nx, side, side}, vec(nx, side, side))) {
    if (distortion > 0.0) {
      Mesh moved = mesh;
      distort(moved, distortion);
      for (std::size_t n = 0; n < mesh.nodes.size(); ++n)
        if (mesh.nodes[n][1] > 1.5) mesh.nodes[n] = moved.nodes[n];
    }
    number_by_rates(mesh, rate);
  }
};

/// Steps with their numbers; returns the ledger of the last step that is a multiple of the period.
engine::Ledger run_at_rates(Solid& solid, int steps, double dt, int first = 0) {
  const int period = static_cast<int>(solid.engine.period());
  engine::Ledger ledger;
  for (int k = first; k < first + steps; ++k) {
    const bool measure = k == first + steps - period;
    solid.engine.step({k * dt, dt, 0.0, measure, static_cast<std::uint64_t>(k)}, solid.nobody);
    if (measure) ledger = solid.engine.ledger();
  }
  return ledger;
}

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

TEST_CASE("the energy at several rates swings within bounds, up to the limit of the step") {
  const Bar bar(32, 4, 2, 4, 8);
  for (const double fraction : {0.5, 0.62, 0.78, 0.9, 0.995}) {
    CAPTURE(fraction);
    Solid solid(bar.mesh, soil);
    solid.engine.prepare();
    const double one_rate = solid.engine.stable_step();
    solid.engine.set_rates(bar.rate);
    const double stable = solid.engine.stable_step();
    CHECK(8 * stable == Approx(one_rate).epsilon(1e-3));
    solid.set_noise(solid.engine.motion.velocity, 1e-3);
    double low = INFINITY, high = 0.0, half[2] = {0.0, 0.0};
    constexpr int parts = 300, period = 8;
    for (int part = 0; part < parts; ++part) {
      const double energy = run_at_rates(solid, 2 * period, fraction * stable, part * 2 * period).balance();
      low = std::min(low, energy);
      high = std::max(high, energy);
      half[2 * part / parts] += energy;
    }
    CHECK(high - low < (fraction > 0.9 ? 0.02 : 0.013) * high);
    CHECK(std::fabs(half[1] - half[0]) < 0.004 * half[0]);  // the swing is not a drift
    CHECK(high - low > 1e-6 * high);  // rates were on
  }
}

namespace {

double entry(const engine::Ledger& ledger, const std::string& name) {
  for (const auto& e : ledger.entries)
    if (e.name == name) return e.energy;
  FAIL("no entry " << name);
  return 0.0;
}

}  // namespace

TEST_CASE("rate_swing is what kinetic + elastic leave out of a motion in elements of rate r") {
  constexpr int length = 24, rate = 4;
  const SolidMaterial strings = isotropic(1e6, 0.0, 1000.0);  // no lateral motion: a bar of springs and masses
  Solid solid(box_mesh({length, 2, 2}, vec(length, 2, 2)), strings);
  solid.engine.prepare();
  const double dt = 0.4 * solid.engine.stable_step() / rate;
  solid.engine.set_rates(Bytes(solid.engine.mesh().elements.size(), rate));
  const double wave_number = 4 * M_PI / length;
  const double omega = 2.0 * std::sqrt(1e6 / 1000.0) * std::sin(0.5 * wave_number);
  const double x = omega * rate * dt;
  for (std::size_t n = 0; n < solid.engine.motion.size(); ++n)
    solid.engine.motion.velocity[n] = vec(1e-3 * std::cos(wave_number * solid.engine.motion.position[n][0]), 0, 0);
  for (int part = 0; part < 10; ++part) {
    const engine::Ledger ledger = run_at_rates(solid, 3 * rate, dt, part * 3 * rate);
    CHECK(entry(ledger, "rate_swing") / ledger.balance() == Approx((1.0 - 1.0 / (rate * rate)) * x * x / 6.0).epsilon(0.3 * x * x));
  }
  solid.engine.set_rates(Bytes(solid.engine.mesh().elements.size(), 1));
  solid.run(1, dt);
  CHECK(entry(solid.engine.ledger(), "rate_swing") == 0.0);
}

TEST_CASE("a packet that goes over from rate 1 to rate 8 keeps balance and swing together") {
  const int length = 180;
  const Bar bar(length, 1, 90, 6, 8);
  Solid solid(bar.mesh, isotropic(1e6, 0.0, 1000.0));
  solid.engine.prepare();
  solid.engine.set_rates(bar.rate);
  const double dt = 0.9 * solid.engine.stable_step(), speed = std::sqrt(1e3), wave_number = 2 * M_PI / 12.0;
  const auto packet = [&](double at) {
    const double s = (at - 45.0) / 11.0;
    return 1e-6 * std::exp(-0.5 * s * s) * std::sin(wave_number * (at - 45.0));
  };
  auto& motion = solid.engine.motion;
  for (std::size_t n = 0; n < motion.size(); ++n) {
    const double at = motion.position[n][0], half = 0.5 * speed * dt;
    motion.displacement[n] = vec(packet(at), 0, 0);
    motion.velocity[n] = vec((packet(at + half + 1e-3) - packet(at + half - 1e-3)) / -2e-3 * speed, 0, 0);
  }
  const int part = 8 * static_cast<int>(std::ceil(90.0 / speed / dt / 8));
  const engine::Ledger before = run_at_rates(solid, 8, dt), after = run_at_rates(solid, part, dt, 8);
  const double energy = before.balance(), seen = after.balance() - energy;
  const double x = 2.0 * std::sqrt(1e3) * std::sin(0.5 * wave_number) * 8 * dt;
  CHECK(seen == Approx(-energy * x * x / 6.0).epsilon(0.25));  // a packet has longer and shorter waves
  CHECK(entry(before, "rate_swing") < 1e-3 * energy);
  CHECK(std::fabs(seen + entry(after, "rate_swing") - entry(before, "rate_swing")) < 0.1 * std::fabs(seen));
}

TEST_CASE("rates that come and go leave the energy") {
  const Bar bar(60, 2, 4, 4, 8);
  Solid solid(bar.mesh, isotropic(1e6, 0.2, 1000.0));
  solid.engine.options.gravity = vec(0.3, 0, -0.5);
  const auto end = solid.nodes([](Vec x) { return x[0] == 60.0; });
  solid.engine.boundary.add(engine::Load{"end", end, VecField(end.size(), vec(0.5, 0, 0.2)), {"constant", {1.0}}}, solid.engine.motion.size());
  solid.hold("base", [](Vec x) { return x[0] == 0.0; }, 7);
  solid.engine.prepare();
  solid.engine.set_rates(bar.rate);
  const double dt = 0.8 * solid.engine.stable_step();
  auto& motion = solid.engine.motion;
  for (std::size_t n = 0; n < motion.size(); ++n)
    motion.velocity[n] = vec(1e-2 * std::sin(motion.position[n][0] * M_PI / 10), 3e-3 * std::sin(motion.position[n][0] * M_PI / 15), 0);
  const Bytes ones(bar.rate.size(), 1);
  int step = 0;
  const auto advance = [&](int steps, double size) {
    const engine::Ledger ledger = run_at_rates(solid, steps, size, step);
    step += steps;
    return ledger;
  };
  const double first = advance(8, dt).balance();
  double largest = 0.0, worst = 0.0, booked = 0.0;
  for (int turn = 0; turn < 20; ++turn) {
    solid.engine.set_rates(ones);
    advance(24, 0.7 * dt);
    solid.engine.set_rates(bar.rate);
    const engine::Ledger ledger = advance(40, turn % 2 == 0 ? dt : 0.9 * dt);
    largest = std::max(largest, entry(ledger, "kinetic") + entry(ledger, "elastic"));
    worst = std::max(worst, std::fabs(ledger.balance() - first));
    booked = std::max(booked, std::fabs(entry(ledger, "step_change")));
  }
  CHECK(booked > 1e-3 * largest);
  CHECK(worst < 5e-4 * largest);  // the swing; velocities left where they were make it 0.09
}

TEST_CASE("a restored engine changes its rates as the unbroken one does, under a load that grows") {
  const Bar bar(24, 2, 2, 3, 8);
  Solid solid(bar.mesh, soil);
  const auto end = solid.nodes([](Vec x) { return x[0] == 24.0; });
  solid.engine.boundary.add(engine::Load{"end", end, VecField(end.size(), vec(5, 0, 2)), {"ramp", {1.0, 0.0, 1.0}}}, solid.engine.motion.size());
  solid.engine.prepare();
  solid.engine.set_rates(bar.rate);
  const double dt = 0.8 * solid.engine.stable_step();
  run_at_rates(solid, 160, dt);
  const auto state = solid.engine.checkpoint();
  const Bytes ones(bar.rate.size(), 1);
  std::uint64_t hash[2];
  for (const bool again : {false, true}) {
    Solid other(bar.mesh, soil);
    Solid& one = again ? other : solid;
    if (again) {
      other.engine.boundary.add(engine::Load{"end", end, VecField(end.size(), vec(5, 0, 2)), {"ramp", {1.0, 0.0, 1.0}}}, other.engine.motion.size());
      other.engine.prepare();
      other.engine.set_rates(bar.rate);
      other.engine.restore(state);
    }
    one.engine.set_rates(ones);
    run_at_rates(one, 5, dt, 160);
    hash[again] = one.engine.state_hash();
  }
  CHECK(hash[0] == hash[1]);
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

TEST_CASE("the ledger at several rates holds loads, dashpots, gravity and a driven face") {
  const Bar bar(24, 3, 2, 4, 8);
  Solid solid(bar.mesh, soil);
  solid.engine.options.gravity = vec(0, 0, -9.81);
  auto& boundary = solid.engine.boundary;
  const std::size_t count = solid.engine.motion.size();
  const auto base = solid.nodes([](Vec x) { return x[2] == 0.0; }), far = solid.nodes([](Vec x) { return x[0] == 24.0; });
  const auto top = solid.nodes([](Vec x) { return x[2] == 3.0; });
  boundary.add(engine::Constraint{"base", base, 7, vec(0, 0, 1), {"half_sine", {0.2, 0.0, 2.0}}}, count);
  boundary.add(engine::Dashpot{"far", far, VecField(far.size(), vec(1e4, 1e4, 1e4))}, count);
  auto backwards = top;  // groups need not ascend
  std::reverse(backwards.begin(), backwards.end());
  boundary.add(engine::Load{"top", backwards, VecField(top.size(), vec(10, 0, -1000)), {"ramp", {1.0, 0.0, 1.0}}}, count);
  solid.engine.prepare();
  const double stable = solid.engine.stable_step();
  solid.engine.set_rates(bar.rate);
  const auto at_rest = solid.engine.checkpoint();
  double error[2];
  for (const int finer : {1, 4}) {  // what does not close is the swing, which goes with the square of the step
    solid.engine.restore(at_rest);
    double largest = 0.0, worst = 0.0;
    const int part = 160 * finer;
    for (int k = 0; k < 20; ++k) {
      const engine::Ledger ledger = run_at_rates(solid, part, 0.9 * stable / 8 / finer, k * part);
      for (const auto& e : ledger.entries) largest = std::max(largest, std::fabs(e.energy));
      worst = std::max(worst, std::fabs(ledger.balance()));
    }
    error[finer > 1] = worst / largest;
  }
  CHECK(error[0] < 0.001);
  CHECK(error[1] < 0.1 * error[0]);
  for (const auto& e : solid.engine.ledger().entries)
    if (e.name != "multipliers" && e.name != "damping" && e.name != "step_change" && e.name != "rate_swing") CHECK(e.energy != 0.0);
  // at rest the base carries the weight and the load, whichever rate its nodes have
  Solid still(bar.mesh, soil);
  still.engine.options.gravity = vec(0, 0, -9.81);
  still.hold("base", [](Vec x) { return x[2] == 0.0; }, 7);
  const auto outlet = still.nodes([](Vec) { return true; });
  still.engine.boundary.add(engine::Dashpot{"all", outlet, VecField(outlet.size(), vec(2e4, 2e4, 2e4))}, count);
  still.engine.prepare();
  still.engine.set_rates(bar.rate);
  run_at_rates(still, 16000, 0.9 * stable / 8);
  CHECK(still.engine.boundary.reactions()[2] == Approx(9.81 * 1000 * 24 * 9).epsilon(1e-6));
  // nodes at a change of rate get the force of their coarser elements in one step of several, and ripple
  CHECK(still.engine.unbalanced() < 0.005);
  double held = 0.0;
  const auto force = still.values("force");
  for (std::size_t n = 0; n < count; ++n) held += force[3 * n + 2];
  CHECK(held == Approx(-9.81 * 1000 * 24 * 9).epsilon(1e-6));
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
