// Lamb's problem: a vertical point force on a half space, seen on its surface.

#include <catch2/catch.hpp>
#include <numbers>

#include "solid_fixture.hpp"

using namespace gabion::continuum;
namespace engine = gabion::engine;
using engine::vec;

namespace {

constexpr double pi = std::numbers::pi;

/// mu r u_z / F on the surface after a step of force, nu = 1/4, tau = c_s t / r (Pekeris 1955). Singular just before the
/// Rayleigh wave at gamma.
double pekeris(double tau) {
  const double root = std::sqrt(3.0), gamma = 0.5 * std::sqrt(3.0 + root);
  if (tau <= 1.0 / root) return 0.0;
  if (tau >= gamma) return 3.0 / (8.0 * pi);
  const double before = std::sqrt(3.0 * root + 5.0) / std::sqrt(0.75 + 0.25 * root - tau * tau);
  if (tau >= 1.0) return (6.0 - before) / (16.0 * pi);
  return (6.0 - root / std::sqrt(tau * tau - 0.25) - before + std::sqrt(3.0 * root - 5.0) / std::sqrt(tau * tau + 0.25 * root - 0.75)) /
         (32.0 * pi);
}

/// Integral of pekeris from 0 to tau: the singularity is integrable.
double pekeris_integral(double tau) {
  const double root = std::sqrt(3.0), gamma = 0.5 * std::sqrt(3.0 + root), first = 1.0 / root;
  const double a = std::sqrt(3.0 * root + 5.0), b = std::sqrt(3.0 * root - 5.0), c2 = 0.75 - 0.25 * root;
  const auto early = [&](double x) {
    return (6.0 * x - root * std::log(x + std::sqrt(x * x - 0.25)) - a * std::asin(x / gamma) + b * std::log(x + std::sqrt(x * x - c2))) /
           (32.0 * pi);
  };
  const auto late = [&](double x) { return (6.0 * x - a * std::asin(std::fmin(1.0, x / gamma))) / (16.0 * pi); };
  double sum = 0.0;
  if (tau > first) sum += early(std::fmin(tau, 1.0)) - early(first);
  if (tau > 1.0) sum += late(std::fmin(tau, gamma)) - late(1.0);
  if (tau > gamma) sum += 3.0 / (8.0 * pi) * (tau - gamma);
  return sum;
}

/// The same for a force that rises as (1 - cos(pi t/T))/2: the step's answer convolved with a half-sine of unit area.
double smooth_answer(double t, double distance, double rise) {
  constexpr int points = 2000;
  double sum = 0.0;
  for (int k = 0; k < points; ++k) {
    const double from = rise * k / points, to = rise * (k + 1) / points;
    const double mean = (pekeris_integral((t - from) / distance) - pekeris_integral((t - to) / distance)) * distance;
    sum += mean * std::sin(0.5 * pi * (from + to) / rise);
  }
  return sum * pi / (2.0 * rise);
}

}  // namespace

TEST_CASE("the closed form of Lamb's problem has its published values") {
  CHECK(pekeris(0.9) == Approx(-0.0090722).epsilon(1e-4));
  CHECK(pekeris(0.99) == Approx(-0.0255826).epsilon(1e-4));
  CHECK(pekeris(1.05) == Approx(-0.1045142).epsilon(1e-4));
  CHECK(pekeris(1.09) == Approx(0.1193662).epsilon(1e-6));
}

TEST_CASE("Lamb: surface motion after a point force on a half space") {
  // unit elements, density and shear modulus: times in element transits of the shear wave. The force rises in 20 of them;
  // in 10 the mesh disperses the Rayleigh wave and the error is 7 %. A quarter of the problem;
  // the outer faces are too far for a P wave to come back.
  constexpr double distance = 24.0, rise = 20.0, end = 64.0, nu = 0.25;
  constexpr int side = 69;
  Solid ground(box_mesh({side, side, side}, vec(side, side, side)), isotropic(2.0 * (1.0 + nu), nu, 1.0), false);
  ground.hold(
      "x", [](Vec p) { return p[0] == 0.0; }, 1);
  ground.hold(
      "y", [](Vec p) { return p[1] == 0.0; }, 2);
  std::vector<double> smooth;
  for (int k = 0; k <= 200; ++k) {
    smooth.push_back(rise * k / 200.0);
    smooth.push_back(0.5 * (1.0 - std::cos(pi * k / 200.0)));
  }
  const auto loaded = ground.nodes([](Vec p) { return p[0] == 0.0 && p[1] == 0.0 && p[2] == 0.0; });
  const auto seen = ground.nodes([](Vec p) { return p[0] == distance && p[1] == 0.0 && p[2] == 0.0; });
  REQUIRE(loaded.size() == 1);
  REQUIRE(seen.size() == 1);
  constexpr double force = 1e-4;
  ground.engine.boundary.add(engine::Load{"point", loaded, VecField(1, vec(0, 0, 0.25 * force)), {"table", smooth}}, ground.engine.motion.size());
  ground.engine.prepare();
  const double dt = 0.9 * ground.engine.stable_step();
  double error = 0.0, size = 0.0, last = 0.0;
  while (ground.time < end) {
    ground.run(1, dt);
    last = distance * ground.engine.motion.displacement[static_cast<std::size_t>(seen[0])][2] / force;
    const double expected = smooth_answer(ground.time, distance, rise);
    error += (last - expected) * (last - expected);
    size += expected * expected;
  }
  CAPTURE(std::sqrt(error / size), last);
  CHECK(std::sqrt(error / size) < 0.02);
  CHECK(last == Approx(3.0 / (8.0 * pi)).epsilon(0.01));
}
