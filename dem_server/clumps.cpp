#include "dem_server/clumps.hpp"

#include <cmath>

#include "protocol/engine/hash.hpp"

namespace gabion::dem {
namespace {

Vec to_body(const std::array<Vec, 3>& axes, Vec x) {
  return vec(dot(x, axes[0]), dot(x, axes[1]), dot(x, axes[2]));
}

/// Matrix given by its columns, times x.
Vec times(const std::array<Vec, 3>& columns, Vec x) {
  return splat(x[0]) * columns[0] + splat(x[1]) * columns[1] + splat(x[2]) * columns[2];
}

/// Local damping: -alpha |F| sign(v), by component.
Vec drag(double alpha, Vec force, Vec velocity) {
  Vec d{};
  for (int axis = 0; axis < 3; ++axis)
    if (velocity[axis] != 0.0) d[axis] = -std::copysign(alpha * std::fabs(force[axis]), velocity[axis]);
  return d;
}

/// exp(a) v, the vector turned by |a| about a (Rodrigues); small angles by series, which is faster.
Vec rotated(Vec v, Vec a) {
  constexpr double series_below = 1e-3;  // of the square; the next terms are below round-off
  const double q = dot(a, a);
  double once, twice;  // sin(x)/x and (1 - cos(x))/x^2
  if (q < series_below) {
    once = 1.0 - q / 6.0 * (1.0 - q / 20.0 * (1.0 - q / 42.0));
    twice = 0.5 - q / 24.0 * (1.0 - q / 30.0 * (1.0 - q / 56.0));
  } else {
    const double x = std::sqrt(q);
    once = std::sin(x) / x;
    twice = (1.0 - std::cos(x)) / q;
  }
  const Vec across = cross(a, v);
  return v + splat(once) * across + splat(twice) * cross(a, across);
}

/// tan(x)/x
double chord_over_arc(double x) {
  constexpr double series_below = 1e-4;  // the next term is x^4/7.5
  return x < series_below ? 1.0 + x * x / 3.0 : std::tan(x) / x;
}

}  // namespace

/// omega of the coming drift. In the body's frame at t_n: omega = J^-1 exp(-omega dt/2) R(n)^T L.
Vec Clumps::midpoint_spin(std::size_t b, double dt) const {
  constexpr int most = 10;
  constexpr double close = 4e-15;
  const Body& body = bodies[b];
  const auto axes = axes_of(body.attitude);
  const Vec momentum = to_body(axes, body.momentum);
  Vec spin = to_body(axes, body.spin);
  for (int k = 0; k < most; ++k) {
    const Vec before = spin;
    spin = times(inverse_[b], rotated(momentum, splat(-0.5 * dt) * before));
    const Vec change = spin - before;
    if (dot(change, change) <= close * close * dot(spin, spin)) break;
  }
  return times(axes, spin);
}

std::array<Vec, 3> Clumps::inverse_inertia(std::size_t b) const {
  const auto axes = axes_of(bodies[b].attitude);
  std::array<Vec, 3> columns;
  for (int c = 0; c < 3; ++c) {
    Vec unit{};
    unit[c] = 1.0;
    columns[c] = times(axes, times(inverse_[b], to_body(axes, unit)));
  }
  return columns;
}

void Clumps::kick(const engine::StepContext& context, engine::Motion& motion, Rotation& rotation) {
  threads_ = motion.threads;
#pragma omp parallel for schedule(static) num_threads(threads_) if (threads_ > 1)
  for (std::size_t b = 0; b < bodies.size(); ++b) kick_one(b, context, motion, rotation);
}

void Clumps::kick_one(std::size_t b, const engine::StepContext& context, engine::Motion& motion, Rotation& rotation) {
  Body& body = bodies[b];
  Step& step = step_[b];
  Vec force{}, torque{};
  bool turns = true;
  for (std::int32_t k = start_[b]; k < start_[b + 1]; ++k) {
    const std::int32_t i = grain_[k];
    const Vec f = motion.force[i];
    force += f;
    torque += rotation.torque[i] + cross(offset_[k] + turn_[k], f);
    turns = turns && rotation.mobility[i] > 0.0;  // a clump of grains that may not turn does not turn
  }
  force[3] = torque[3] = 0.0;
  if (!turns) {
    torque = Vec{};
    body.momentum = body.spin = Vec{};
  }
  step.old_velocity = body.velocity;
  step.old_momentum = body.momentum;
  step.old_spin = body.spin;
  step.damping_force = step.damping_torque = Vec{};
  if (context.damping > 0.0) {
    step.damping_force = drag(context.damping, force, body.velocity);
    step.damping_torque = drag(context.damping, torque, body.spin);
  }
  const Vec dt = splat(context.dt);
  body.velocity += dt * (force + step.damping_force) / splat(mass_[b]);
  step.next = body.attitude;
  if (turns) {
    body.momentum += dt * (torque + step.damping_torque);
    body.spin = midpoint_spin(b, context.dt);
    step.next = turned(body.attitude, dt * body.spin);
    step.chord = chord_over_arc(0.5 * context.dt * norm(body.spin));
  }
  move_members(b, motion, rotation);
}

/// Velocity and spin over the coming drift.
void Clumps::move_members(std::size_t b, engine::Motion& motion, Rotation& rotation) {
  const Body& body = bodies[b];
  const Step& step = step_[b];
  const Vec chord = splat(step.chord) * body.spin;
  for (std::int32_t k = start_[b]; k < start_[b + 1]; ++k) {
    const std::int32_t i = grain_[k];
    next_turn_[k] = turn_of(step.next, offset_[k]);
    motion.velocity[i] = body.velocity + cross(chord, offset_[k] + splat(0.5) * (turn_[k] + next_turn_[k]));
    rotation.spin[i] = body.spin;
    // drag acts on the body
    if (!motion.damping_force.empty()) motion.damping_force[i] = Vec{};
    if (!rotation.damping_torque.empty()) rotation.damping_torque[i] = Vec{};
  }
}

void Clumps::drift(const engine::StepContext& context, engine::Motion& motion) {
  if (motion.measured) {  // always: the second half of the last damped step is still to be added
    double first = 0.0, second = 0.0;
    for (std::size_t b = 0; context.damping > 0.0 && b < bodies.size(); ++b) {
      const Step& s = step_[b];
      first += dot(s.damping_force, s.old_velocity) + dot(s.damping_torque, s.old_spin);
      second += dot(s.damping_force, bodies[b].velocity) + dot(s.damping_torque, bodies[b].spin);
    }
    damping_work.add(0.5 * context.dt * first, 0.5 * context.dt * second);
  }
  const Vec dt = splat(context.dt);
#pragma omp parallel for schedule(static) num_threads(threads_) if (threads_ > 1)
  for (std::size_t b = 0; b < bodies.size(); ++b) {
    bodies[b].displacement += dt * bodies[b].velocity;
    bodies[b].attitude = step_[b].next;
    for (std::int32_t k = start_[b]; k < start_[b + 1]; ++k) turn_[k] = next_turn_[k];
    put_members(b, motion);
  }
}

void Clumps::put_members(std::size_t b, engine::Motion& motion) const {
  for (std::int32_t k = start_[b]; k < start_[b + 1]; ++k)
    motion.displacement[grain_[k]] = bodies[b].displacement + turn_[k];
}

double Clumps::kinetic_difference(const engine::Motion& motion) const {
  double twice = 0.0;
  for (std::size_t b = 0; b < bodies.size(); ++b) {
    twice += mass_[b] * dot(step_[b].old_velocity, bodies[b].velocity);
    for (const std::int32_t i : members(b)) twice -= motion.mass[i] * dot(motion.old_velocity[i], motion.velocity[i]);
  }
  return 0.5 * twice;
}

double Clumps::rotational_difference(const Rotation& rotation) const {
  double twice = 0.0;
  for (std::size_t b = 0; b < bodies.size(); ++b) {
    const Step& s = step_[b];
    // the attitude differs between the two half steps: the mean of both products is their common value at t_n
    twice += 0.5 * (dot(s.old_spin, bodies[b].momentum) + dot(bodies[b].spin, s.old_momentum));
    for (const std::int32_t i : members(b)) twice -= rotation.inertia[i] * dot(rotation.old_spin[i], rotation.spin[i]);
  }
  return 0.5 * twice;
}

Vec Clumps::angular_momentum_difference(const engine::Motion& motion, const Rotation& rotation) const {
  Vec total{};
  for (std::size_t b = 0; b < bodies.size(); ++b) {
    const Body& body = bodies[b];
    total += cross(centre_[b] + body.displacement, splat(mass_[b]) * body.velocity) + body.momentum;
    for (const std::int32_t i : members(b))
      total -= cross(motion.position[i] + motion.displacement[i], splat(motion.mass[i]) * motion.velocity[i]) +
               splat(rotation.inertia[i]) * rotation.spin[i];
  }
  return total;
}

double Clumps::mean_unbalanced_force(const engine::Motion& motion) const {
  const auto grains = static_cast<double>(motion.size());
  double total = motion.mean_unbalanced_force() * grains;
  for (std::size_t b = 0; b < bodies.size(); ++b) {
    Vec force{};
    for (const std::int32_t i : members(b)) {
      force += motion.force[i];
      total -= norm(motion.force[i]);
    }
    total += norm(force);
  }
  return std::fmax(0.0, total) / (grains - static_cast<double>(grain_.size()) + static_cast<double>(bodies.size()));
}

void Clumps::drop_internal(std::vector<Pair>& pairs) const {
  std::erase_if(pairs, [&](const Pair& p) {
    const std::int32_t b = body_of_[p.i];
    if (b < 0 || b != body_of_[p.j]) return false;
    const auto &from = image_[place_of_[p.i]], &to = image_[place_of_[p.j]];
    for (int axis = 0; axis < 3; ++axis)
      if (to[axis] - from[axis] != p.image[axis]) return false;  // the clump's own image is a neighbour like any other
    return true;
  });
}

std::int32_t Clumps::first_bound_member(const engine::Motion& motion, std::size_t limit) const {
  for (const std::int32_t i : grain_) {
    bool bound = static_cast<std::size_t>(i) < limit || motion.mass[i] < motion.plain_mass[i];
    for (int axis = 0; axis < 3; ++axis) {
      bound = bound || !(motion.freedom[i][axis] > 0.0);
      if (!motion.viscosity.empty()) bound = bound || motion.viscosity[i][axis] != 0.0;
    }
    if (bound) return i;
  }
  return -1;
}

std::uint64_t Clumps::grouping_key() const {
  engine::Hash hash;
  for (const std::int32_t s : start_) hash.add(static_cast<std::uint64_t>(s));
  for (const std::int32_t i : grain_) hash.add(static_cast<std::uint64_t>(i));
  return empty() ? 0 : hash.value();
}

}  // namespace gabion::dem
