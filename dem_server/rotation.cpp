#include "dem_server/rotation.hpp"

#include <algorithm>

namespace gabion::dem {
namespace {

Vec sign(Vec a) {
  const Vec zero{};
  const Vec one = splat(1.0);
  return (a > zero ? one : zero) - (a < zero ? one : zero);
}

Vec magnitude(Vec a) {
  return a > Vec{} ? a : -a;
}

}  // namespace

void Rotation::resize(std::size_t n) {
  for (VecField* field : {&angle, &spin, &torque}) field->assign(n, Vec{});
  inertia.assign(n, 0.0);
  mobility.assign(n, 0.0);
  set_measured(measured);
}

void Rotation::set_measured(bool on) {
  measured = on;
  old_spin.assign(on ? size() : 0, Vec{});
  damping_torque.assign(on ? size() : 0, Vec{});
}

void Rotation::trial(const engine::StepContext& context) {
  const bool damped = context.damping > 0.0;
#pragma omp parallel for schedule(static) num_threads(threads) if (threads > 1)
  for (std::size_t i = 0; i < size(); ++i) {
    const Vec w = spin[i];
    Vec t = torque[i];
    if (damped) {
      const Vec drag = splat(mobility[i] > 0.0 ? -context.damping : 0.0) * magnitude(t) * sign(w);
      if (measured) damping_torque[i] = drag;
      t += drag;
    }
    if (measured) old_spin[i] = w;
    spin[i] = w + splat(context.dt * mobility[i]) * t;
  }
}

void Rotation::drift(const engine::StepContext& context) {
  if (measured) {  // always: the second half of the last damped step is still to be added
    double first = 0.0, second = 0.0;
    for (std::size_t i = 0; context.damping > 0.0 && i < size(); ++i) {
      first += dot(damping_torque[i], old_spin[i]);
      second += dot(damping_torque[i], spin[i]);
    }
    damping_work.add(0.5 * context.dt * first, 0.5 * context.dt * second);
  }
  const Vec dt = splat(context.dt);
  // as in Motion::drift
  constexpr std::size_t block = 512;
  const std::size_t blocks = (size() + block - 1) / block;
  bool sound = true;
#pragma omp parallel for schedule(static) reduction(&& : sound) num_threads(threads) if (threads > 1)
  for (std::size_t b = 0; b < blocks; ++b) {
    const std::size_t last = std::min(size(), (b + 1) * block);
    Vec nothing{};
    for (std::size_t i = b * block; i < last; ++i) {
      angle[i] += dt * spin[i];
      nothing += splat(0.0) * spin[i];
    }
    sound = sound && sum(nothing) == 0.0;
  }
  finite = sound;
}

double Rotation::kinetic_energy() const {
  double twice = 0.0;
  for (std::size_t i = 0; i < old_spin.size(); ++i) twice += inertia[i] * dot(old_spin[i], spin[i]);
  return 0.5 * twice;
}

double Rotation::power_before() const {
  double power = 0.0;
  for (std::size_t i = 0; i < old_spin.size(); ++i) power += dot(torque[i], old_spin[i]);
  return power;
}

Vec Rotation::momentum() const {
  Vec total{};
  for (std::size_t i = 0; i < size(); ++i) total += splat(inertia[i]) * spin[i];
  return total;
}

}  // namespace gabion::dem
