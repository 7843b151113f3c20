// The step where elements have several rates: ContinuumEngine::step in the same order, for the tiers that take part.

#include <algorithm>

#include "continuum_server/continuum_engine.hpp"

namespace gabion::continuum {

using engine::Exchange;
using engine::RequestError;
using engine::StepContext;
using engine::Tier;

void ContinuumEngine::set_rates(std::span<const std::uint8_t> rate) {
  if (!prepared_) throw RequestError("RATES", "the engine is not prepared", "send PREPARE first");
  Rates rates = make_rates(mesh_, rate);
  check_margin(rates, mesh_, tie.reach());
  const bool moving = past_step_ > 0.0;
  const NextImpulse before = moving ? next_impulse() : NextImpulse{};
  rates_ = std::move(rates);
  motion.tiers.clear();
  if (rates_.several())
    for (std::size_t t = 0; t < rates_.tiers(); ++t)
      motion.tiers.push_back({static_cast<std::size_t>(rates_.nodes[t].first), static_cast<std::size_t>(rates_.nodes[t].last), rates_.rate[t]});
  forces_.set_rates(rates_);
  mean_velocity_.resize(rates_.several() && motion.measured ? motion.size() : 0);
  rate_swing_ = 0.0;
  reach_ = tie.reach();
  forces_.arrange(reach_, arranged_threads_);
  step_size_ = 0.0;
  if (moving) bring_velocities(before);
}

/// What each node will be given in the next step at the present rates, dashpots apart, N s. Every node takes part in it.
ContinuumEngine::NextImpulse ContinuumEngine::next_impulse() const {
  NextImpulse next{VecField(motion.size(), Vec{}), VecField(motion.size(), Vec{})};
  boundary.add_loads(next.of_loads, time_, 0, motion.size());
  forces_.start(body_, next.of_all);
  forces_.subtract(Part::interface, motion.displacement, next.of_all, rates_.tiers());
  forces_.subtract(Part::interior, motion.displacement, next.of_all, rates_.tiers());
  for (std::size_t t = 0; t < rates_.tiers(); ++t) {
    const Vec own = engine::splat(static_cast<double>(rates_.rate[t]) * past_step_);
    for (std::int32_t n = rates_.nodes[t].first; n < rates_.nodes[t].last; ++n) {
      next.of_loads[n] *= own;
      next.of_all[n] = motion.freedom[n] * (own * next.of_all[n] + next.of_loads[n]);
    }
  }
  return next;
}

/// Velocities stand half an own step back, v = v_n - J/(2 m) with the impulse J of the next step; at other rates J is another
/// one. What the energy jumps by, since a motion counts for less at a larger rate, is booked with the changes of step.
void ContinuumEngine::bring_velocities(const NextImpulse& before) {
  const NextImpulse after = next_impulse();
  double jump = 0.0;
  for (std::size_t n = 0; n < motion.size(); ++n) {
    const Vec was = motion.velocity[n], per_mass = engine::splat(1.0 / motion.mass[n]);
    const Vec now = was + engine::splat(0.5) * per_mass * (before.of_all[n] - after.of_all[n]);
    motion.velocity[n] = now;
    jump += 0.5 * motion.mass[n] * (engine::dot(now, now + per_mass * after.of_all[n]) - engine::dot(was, was + per_mass * before.of_all[n]));
    jump -= 0.5 * (engine::dot(after.of_loads[n], now) - engine::dot(before.of_loads[n], was));
  }
  if (motion.measured) step_change_ -= jump;
  for (engine::Work* work : {&motion.damping_work, &motion.dashpot_work, &boundary.load_work, &boundary.constraint_work}) work->merge_tiers();
}

/// Tied nodes are of the first tier and no coarser element touches the interface's (check_margin), so that what is sent
/// is complete before the coarser tiers are looked at.
bool ContinuumEngine::step_at_rates(const StepContext& context, Exchange& exchange) {
  const bool tied = tie.mode() != engine::Tie::Mode::none;
  const std::size_t reach = tie.reach(), active = rates_.active(context.step);

  forces_.start({}, motion.force, active);
  forces_.subtract(Part::interface, motion.displacement, motion.force, active);
  add_outer_forces(context, 0, reach);
  motion.trial(0, reach, context);
  boundary.prescribe(motion, context, 0, reach);
  if (tied) exchange.send_gap(tie.project(motion, context));

  forces_.subtract(Part::interior, motion.displacement, motion.force, active);
  for (std::size_t t = 0; t < active; ++t) {
    const Tier& tier = motion.tiers[t];
    const StepContext own = tier.own(context);
    const std::size_t first = std::max(tier.first, reach);
    add_outer_forces(own, first, tier.last);
    motion.trial(first, tier.last, own);
    boundary.prescribe(motion, own, first, tier.last);
  }

  const bool more = !tied || exchange.receive_multipliers(tie.answer_buffer());
  if (tied) tie.correct(motion, context);
  for (std::size_t t = 0; t < active; ++t)
    boundary.book(motion, motion.tiers[t].own(context), motion.tiers[t].first, motion.tiers[t].last, t);
  book_step_change_at_rates(context);
  if (context.measure) {
    measure_stored_energy();
    measure_rate_swing(context.dt);
  }
  for (std::size_t t = 0; t < active; ++t)
    motion.drift(motion.tiers[t].own(context), motion.tiers[t].first, motion.tiers[t].last, t);
  if (context.measure || !motion.finite) check_health();
  return more;
}

/// As book_step_change, each node with its own step.
void ContinuumEngine::book_step_change_at_rates(const StepContext& context) {
  if (motion.measured && past_step_ != 0.0 && past_step_ != context.dt) {
    VecField load(motion.size(), Vec{});
    boundary.add_loads(load, context.time, 0, motion.size());
    double power = 0.0;
    for (const Tier& tier : motion.tiers)
      for (std::size_t n = tier.first; n < tier.last; ++n)
        power += static_cast<double>(tier.rate) * engine::dot(motion.force[n] - load[n], motion.old_velocity[n]);
    step_change_ -= 0.5 * (context.dt - past_step_) * power;
  }
  past_step_ = context.dt;
}

/// kinetic + elastic is what a leapfrog keeps exactly, but a motion of frequency omega stands in it with sin(x)/x of its
/// energy, x = omega r dt. What is missing, to x^2, beyond what is missing at rate 1:
///
///   sum of (r^2 - 1) dt^2/12 (V . K V + F . M^-1 F)
///
/// the second term of the modified energy of backward error analysis, for a leapfrog (Hairer, Lubich & Wanner 2006, IX),
/// over each rate on its own. F is the force that moved the node in this step, loads and tie included.
void ContinuumEngine::measure_rate_swing(double dt) {
  if (!motion.measured) return;
  double nodes = 0.0;
  for (const Tier& tier : motion.tiers) {
    const auto rate = static_cast<double>(tier.rate);
    double part = 0.0;
    for (std::size_t n = tier.first; n < tier.last; ++n) {
      const Vec v0 = motion.old_velocity[n], v1 = motion.velocity[n];
      mean_velocity_[n] = engine::splat(0.5) * (v0 + v1);
      part += motion.mass[n] * engine::dot(v1 - v0, v1 - v0);  // (r dt F)^2/m
    }
    nodes += (1.0 - 1.0 / (rate * rate)) * part;
  }
  rate_swing_ = nodes / 12.0 + dt * dt / 6.0 * forces_.excess_energy(mean_velocity_);
}

/// Body forces and loads, once the elements' sums are raised.
void ContinuumEngine::add_outer_forces(const StepContext& context, std::size_t first, std::size_t last) {
  if (!body_.empty())
    for (std::size_t n = first; n < last; ++n) motion.force[n] += body_[n];
  boundary.add_loads(motion.force, context.time, first, last);
}

/// Forces as they are now, without the tie. motion.force holds the impulse of each node's last step, with those of
/// coarser elements in it or not.
VecField ContinuumEngine::present_forces() const {
  VecField force(motion.size());
  forces_.start(body_, force);
  forces_.subtract(Part::interface, motion.displacement, force);
  forces_.subtract(Part::interior, motion.displacement, force);
  boundary.add_loads(force, time_, 0, motion.size());
  return force;
}

}  // namespace gabion::continuum
