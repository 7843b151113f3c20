// Physics: bars and plane waves against closed forms.

#include <catch2/catch.hpp>
#include <numbers>

#include "solid_fixture.hpp"

using namespace gabion::continuum;
namespace engine = gabion::engine;
using engine::norm;
using engine::vec;

namespace {

constexpr double pi = std::numbers::pi;

/// A bar of length, modulus, density and section 1: times come out in units of L/c. Displacements are given in units
/// of s0 L/E.
struct Bar : Solid {
  static constexpr double stress_unit = 1e-3;
  static constexpr int elements = 200;
  double dt = 0.0;

  explicit Bar(engine::History stress)
      : Solid(box_mesh({1, 1, elements}, vec(1, 1, 1)), isotropic(1.0, 0.0, 1.0), false) {
    hold(
        "base", [](Vec x) { return x[2] == 0.0; }, 7);
    const auto head = nodes([](Vec x) { return x[2] == 1.0; });
    engine.boundary.add(engine::Load{"head", head, VecField(4, vec(0, 0, 0.25 * stress_unit)), std::move(stress)},
                        engine.motion.size());
    engine.prepare();
    dt = 0.9 * engine.stable_step();
  }

  double head() const { return engine.motion.displacement.back()[2] / stress_unit; }
  double middle() const { return engine.motion.displacement[4 * (elements / 2)][2] / stress_unit; }

  void run_until(double end, const std::function<void()>& look) {
    while (time < end) {
      run(1, dt);
      look();
    }
  }
};

}  // namespace

TEST_CASE("bar under a half-sine on the head: peaks at head and middle") {
  const auto [duration, head, middle] = GENERATE(
      table<double, double, double>({{1, .6366, .6366}, {2, 1.2732, .9003}, {4, 1.5738, .9321}, {8, 1.2061, .6602}}));
  Bar bar({"half_sine", {1.0, 0.0, duration}});
  double peak_head = 0.0, peak_middle = 0.0;
  bar.run_until(duration + 2.0, [&] {
    peak_head = std::max(peak_head, bar.head());
    peak_middle = std::max(peak_middle, bar.middle());
  });
  CAPTURE(duration);
  CHECK(peak_head == Approx(head).epsilon(0.005));
  CHECK(peak_middle == Approx(middle).epsilon(0.005));
}

TEST_CASE("bar under a step load: twice the static head displacement, a plateau in the middle") {
  Bar bar({"constant", {1.0}});
  double peak = 0.0, plateau = 0.0;
  int samples = 0;
  bar.run_until(2.4, [&] {
    peak = std::max(peak, bar.head());
    if (bar.time > 1.6) plateau += bar.middle(), ++samples;
  });
  CHECK(peak == Approx(2.0).epsilon(0.005));
  CHECK(plateau / samples == Approx(1.0).epsilon(0.005));
}

TEST_CASE("plane waves in a periodic column one element wide have the lumped mesh's dispersion exactly") {
  const int count = 24, waves = 3;
  const double poisson = 0.3;
  const SolidMaterial soil = isotropic(1.0, poisson, 1.0);
  for (const int polarisation : {2, 0}) {
    CAPTURE(polarisation);
    Solid solid(box_mesh({1, 1, count}, vec(1, 1, count), {true, true, true}), soil, false, vec(1, 1, count));
    solid.engine.prepare();
    REQUIRE(solid.engine.motion.size() == count);
    CHECK(solid.engine.motion.mass[0] == Approx(1.0).epsilon(1e-14));
    const double modulus = polarisation == 2 ? soil.stiffness[0] : soil.stiffness[21];
    const double k = 2 * pi * waves / count, dt = 0.8 * solid.engine.stable_step();
    const double omega = 2 / dt * std::asin(dt * std::sqrt(modulus) * std::sin(k / 2));
    const auto wave = [&](Vec x, double t) {
      Vec u{};
      u[polarisation] = 1e-3 * std::cos(k * x[2] - omega * t);
      return u;
    };
    solid.set(solid.engine.motion.displacement, [&](Vec x) { return wave(x, 0); });
    solid.set(solid.engine.motion.velocity, [&](Vec x) { return (wave(x, 0) - wave(x, -dt)) / dt; });
    solid.run(1000, dt);
    double error = 0.0;
    for (std::size_t n = 0; n < solid.engine.motion.size(); ++n)
      error = std::max(error,
                       norm(solid.engine.motion.displacement[n] - wave(solid.engine.motion.position[n], solid.time)));
    CHECK(error < 1e-12);
  }
}

TEST_CASE("an absorbing end takes a plane P wave") {
  const int count = 200;
  const SolidMaterial soil = isotropic(1.0, 0.3, 1.0);
  const double speed = std::sqrt(soil.stiffness[0]);
  Solid solid(box_mesh({1, 1, count}, vec(1, 1, count), {true, true, false}), soil, true, vec(1, 1, count));
  solid.engine.boundary.add(engine::Dashpot{"base", {0}, {vec(0, 0, speed)}}, solid.engine.motion.size());
  solid.engine.prepare();
  const double dt = 0.9 * solid.engine.stable_step();
  // a bell of about 40 elements on its way down, from the middle
  const auto bell = [&](double z) { return 1e-3 * std::exp(-std::pow((z - 100.0) / 12.0, 2)); };
  solid.set(solid.engine.motion.displacement, [&](Vec x) { return vec(0, 0, bell(x[2])); });
  solid.set(solid.engine.motion.velocity,
            [&](Vec x) { return vec(0, 0, (bell(x[2]) - bell(x[2] - speed * dt)) / dt); });
  solid.run(1, dt);
  const auto stored = [&] {
    const auto ledger = solid.engine.ledger();
    return ledger.entries[0].energy + ledger.entries[1].energy;
  };
  const double before = stored(), balance = solid.engine.ledger().balance();
  solid.run(static_cast<int>(170 / (speed * dt)), dt);
  CAPTURE(stored() / before);
  CHECK(stored() < 1e-4 * before);
  CHECK(solid.engine.ledger().balance() == Approx(balance).epsilon(1e-12));
}
