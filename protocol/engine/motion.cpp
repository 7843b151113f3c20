#include "protocol/engine/motion.hpp"

#include <algorithm>

namespace gabion::engine {

namespace {

/// -1, 0 or 1 in each component.
Vec sign(Vec a) {
  const Vec zero{};
  const Vec one = splat(1.0);
  return (a > zero ? one : zero) - (a < zero ? one : zero);
}

Vec magnitude(Vec a) { return a > Vec{} ? a : -a; }

}  // namespace

void Motion::resize(std::size_t n, bool measure_energy) {
  measured = measure_energy;
  tiers.clear();
  for (VecField* field : {&position, &displacement, &velocity, &force, &tie_force, &mobility})
    field->assign(n, Vec{});
  freedom.assign(n, vec(1, 1, 1));
  mass.assign(n, 0.0);
  plain_mass.assign(n, 0.0);
  viscosity.clear();
  old_velocity.assign(measured ? n : 0, Vec{});
  damping_force.assign(measured ? n : 0, Vec{});
}

void Motion::set_step(double dt) {
  if (tiers.empty()) set_step(dt, 0, size());
  for (const Tier& tier : tiers) set_step(static_cast<double>(tier.rate) * dt, tier.first, tier.last);
}

void Motion::set_step(double dt, std::size_t first, std::size_t last) {
  for (std::size_t i = first; i < last; ++i) {
    Vec inertia = splat(mass[i]);
    if (!viscosity.empty()) inertia += splat(0.5 * dt) * viscosity[i];
    mobility[i] = freedom[i] / inertia;
  }
}

void Motion::trial(std::size_t first, std::size_t last, const StepContext& context) {
  const Vec dt = splat(context.dt);
  const Vec alpha = splat(context.damping);
  const bool damped = context.damping > 0.0;
  const bool viscous = !viscosity.empty();
#pragma omp parallel for schedule(static) num_threads(threads) if (threads > 1)
  for (std::size_t i = first; i < last; ++i) {
    const Vec v = velocity[i];
    Vec f = force[i];
    if (damped) {
      const Vec drag = -alpha * freedom[i] * magnitude(f + tie_force[i]) * sign(v);
      if (measured) damping_force[i] = drag;
      f += drag;
    }
    if (measured) old_velocity[i] = v;
    Vec impulse = dt * f;
    if (viscous) impulse -= dt * viscosity[i] * v;
    velocity[i] = v + mobility[i] * impulse;
  }
}

void Motion::drift(const StepContext& context, std::size_t from, std::size_t to, std::size_t tier) {
  const Vec dt = splat(context.dt);
  if (measured) {  // always: the second half of the last damped step is still to be added
    double first = 0, second = 0, first_viscous = 0, second_viscous = 0;
    const bool lossy = context.damping > 0.0 || !viscosity.empty();
    for (std::size_t i = from; lossy && i < to; ++i) {
      const Vec v0 = old_velocity[i], v1 = velocity[i];
      if (context.damping > 0.0) {
        first += dot(damping_force[i], v0);
        second += dot(damping_force[i], v1);
      }
      if (!viscosity.empty()) {
        const Vec drag = splat(-0.5) * freedom[i] * viscosity[i] * (v0 + v1);
        first_viscous += dot(drag, v0);
        second_viscous += dot(drag, v1);
      }
    }
    damping_work.add(0.5 * context.dt * first, 0.5 * context.dt * second, tier);
    dashpot_work.add(0.5 * context.dt * first_viscous, 0.5 * context.dt * second_viscous, tier);
  }
  // 0 v is 0, or not a number where v is none: one sum tells for a block of points
  constexpr std::size_t block = 512;
  const std::size_t blocks = (to - from + block - 1) / block;
  bool sound = true;
#pragma omp parallel for schedule(static) reduction(&& : sound) num_threads(threads) if (threads > 1)
  for (std::size_t b = 0; b < blocks; ++b) {
    const std::size_t last = std::min(to, from + (b + 1) * block);
    Vec nothing{};
    for (std::size_t i = from + b * block; i < last; ++i) {
      displacement[i] += dt * velocity[i];
      nothing += splat(0.0) * velocity[i];
    }
    sound = sound && sum(nothing) == 0.0;
  }
  finite = (from == 0 || finite) && sound;
}

double Motion::kinetic_energy() const {
  double twice = 0.0;
  for (std::size_t i = 0; i < size(); ++i) twice += mass[i] * dot(old_velocity[i], velocity[i]);
  return 0.5 * twice;
}

double Motion::power_before() const {
  double power = 0.0;
  for (std::size_t i = 0; i < size(); ++i) power += dot(force[i], old_velocity[i]);
  return power;
}

std::vector<double> Motion::momentum() const {
  Vec linear{}, angular{};
  double scale = 0.0;
  for (std::size_t i = 0; i < size(); ++i) {
    const Vec p = splat(mass[i]) * velocity[i];
    linear += p;
    angular += cross(position[i] + displacement[i], p);
    scale += norm(p);
  }
  return {linear[0], linear[1], linear[2], angular[0], angular[1], angular[2], scale};
}

double Motion::largest_speed() const {
  double largest = 0.0;
  for (const Vec v : velocity) {
    const double square = dot(v, v);
    if (!(square <= largest)) largest = square;  // also catches NaN,
    if (std::isnan(square)) break;               // which the next one would overwrite
  }
  return std::sqrt(largest);
}

double Motion::mean_unbalanced_force(const VecField& forces) const {
  double total = 0.0;
  for (std::size_t i = 0; i < size(); ++i) total += norm(freedom[i] * (forces[i] + tie_force[i]));
  return size() == 0 ? 0.0 : total / static_cast<double>(size());
}

}  // namespace gabion::engine
