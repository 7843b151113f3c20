// Figures of an impact from histories with a closed form.

#include <catch2/catch.hpp>
#include <cmath>

#include "coupler/run/impact_figures.hpp"

using namespace gabion::coupler;

namespace {

constexpr double mass = 1e4, speed = 13.0, release = 0.5;
const double pi = std::acos(-1.0);

/// A block on a linear spring without gravity: stops after a quarter of a period, at X = v/omega, and stays there.
ImpactFigures on_a_spring(double stop, double step, double until) {
  const double omega = 0.5 * pi / stop;
  ImpactFigures impact;
  for (double t = step; t < until + 0.5 * step; t += step) {
    const double from = std::min(t - step, stop), to = std::min(t, stop);
    const double mean = mass * speed * (std::cos(omega * from) - std::cos(omega * to)) / step;
    impact.add(release + t, speed / omega * std::sin(omega * to), speed * std::cos(omega * to), mean,
               t <= stop ? mass * speed * omega * std::sin(omega * to) : 0.0);
  }
  return impact;
}

}  // namespace

TEST_CASE("a linear force has S = 2") {
  const double stop = 0.061, energy = 0.5 * mass * speed * speed;
  const auto figures = on_a_spring(stop, 1e-4, 0.1).figures(release, mass, speed, energy, 0.0);
  const double omega = 0.5 * pi / stop, force = mass * speed * omega;
  CHECK(figures.at("largest_force").get<double>() == Approx(force).epsilon(1e-4));
  // the force ends where it is largest: half of the window sees nothing, so the mean is that of the last 4 ms
  CHECK(figures.at("largest_force_4ms").get<double>() == Approx(mass * speed * std::cos(omega * (stop - 4e-3)) / 4e-3).epsilon(2e-3));
  CHECK(figures.at("S").get<double>() == Approx(2.0).epsilon(0.01));
  CHECK(figures.at("penetration_end").get<double>() == Approx(speed / omega).epsilon(1e-6));
  CHECK(figures.at("penetration_60ms").get<double>() == Approx(speed / omega * std::sin(omega * 0.06)).epsilon(1e-6));
  CHECK(figures.at("impulse_end").get<double>() == Approx(mass * speed).epsilon(1e-9));
  // down to 5 % of the speed: cos(omega t) = 0.05
  CHECK(figures.at("time_to_stop").get<double>() == Approx(std::acos(0.05) / omega).margin(1e-4));
  CHECK(figures.at("time_to_first_stop").get<double>() == Approx(std::acos(0.05) / omega).margin(2e-4));
  CHECK(figures.at("penetration_first_stop").get<double>() == Approx(speed / omega * std::sqrt(1.0 - 0.05 * 0.05)).epsilon(1e-3));
}

TEST_CASE("a history that is too short leaves figures out") {
  const auto figures = on_a_spring(0.061, 1e-4, 0.03).figures(release, mass, speed, 845e3, 0.0);
  CHECK_FALSE(figures.contains("penetration_60ms"));
  CHECK_FALSE(figures.contains("time_to_stop"));
}

TEST_CASE("a resumed history gives the same figures") {
  const ImpactFigures whole = on_a_spring(0.061, 1e-4, 0.1);
  ImpactFigures again;
  again.remember(whole.memory());
  CHECK(again.figures(release, mass, speed, 845e3, 9.81) == whole.figures(release, mass, speed, 845e3, 9.81));
}
