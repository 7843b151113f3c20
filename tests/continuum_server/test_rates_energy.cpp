// Elements of several rates: what their energy does, and what the ledger says of it.

#include "rates_fixture.hpp"

using namespace gabion::continuum;
namespace engine = gabion::engine;
using engine::vec;

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
