#include "dem_server/engine.hpp"

#include <algorithm>
#include <cmath>
#include <string>

namespace gabion::dem {

using engine::PhysicsError;
using engine::StepContext;

DemEngine::DemEngine() = default;
DemEngine::~DemEngine() = default;

bool DemEngine::step(const StepContext& context, engine::Exchange& exchange) {
  const std::size_t all = grains_.size(), interface = interface_limit();
  const bool tied = tie.mode() != engine::Tie::Mode::none;
  begin_step(context);
  external_forces(context);
  surface_forces();

  contact_forces(0, interface);
  motion.trial(0, interface, context);
  boundary.prescribe(motion, context, 0, interface);
  sponge_.absorb(motion);
  if (tied) exchange.send_gap(tie.project(motion, context));

  contact_forces(interface, all);
  motion.trial(interface, all, context);
  boundary.prescribe(motion, context, interface, all);
  if (contact_options_.rotations) rotation_.trial(context);
  if (!clumps_.empty()) clumps_.kick(context, motion, rotation_);
  if (block_.present()) block_.kick(context, options.gravity);

  bool go_on = true;
  if (tied) {
    go_on = exchange.receive_multipliers(tie.answer_buffer());
    tie.correct(motion, context);
  }
  sponge_.book(motion);
  boundary.book(motion, context);
  book_step_change(context.dt);
  if (context.measure) measure_potentials();
  drift(context);
  if (!motion.finite || !rotation_.finite) check_motion();
  if (context.measure) close_ledger();
  return go_on;
}

std::size_t DemEngine::interface_limit() const {
  return std::max(tie.reach(), sponge_.reach());
}

void DemEngine::begin_step(const StepContext& context) {
  if (context.dt != step_size_) motion.set_step(step_size_ = context.dt);
  if (rotation_groups() != held_groups_) hold_rotations();  // groups may change between runs
  if (!clumps_.empty()) refuse_bound_clumps();
  if (contact_options_.geometry == Geometry::updated) {
    refresh_contacts();
    return;
  }
  constexpr std::uint64_t steps_between_checks = 64;
  if (steps_++ % steps_between_checks == 0) check_motion();
}

void DemEngine::refresh_contacts() {
  const double limit = search_limit();
  bool moved = false;
#pragma omp parallel for schedule(static) reduction(|| : moved) num_threads(threads) if (threads > 1)
  for (std::size_t i = 0; i < grains_.size(); ++i) {
    const Vec since = motion.displacement[i] - displacement_at_build_[i];
    moved = moved || !(dot(since, since) <= limit);  // also when it is not a number
  }
  const bool surfaces_moved = (!walls_.empty() && walls_.largest_travel() > 0.5 * skin_) ||
                              (block_.present() && block_.largest_travel() > 0.5 * skin_);
  if (!moved && surfaces_moved) find_surfaces();
  if (!moved) return;

  check_motion();
  contact_.table = renewed_table(source(), contact_.table, near_pairs());
  contact_.table_changed(grains_.size());
  find_surfaces();
  displacement_at_build_ = motion.displacement;
  strain_at_build_ = 0.0;
  ++rebuilds_;
  count_lost();
}

std::vector<Pair> DemEngine::near_pairs() const {
  try {
    std::vector<Pair> pairs = find_pairs(present_positions(), grains_.radius, skin_, built_domain_);
    if (!clumps_.empty()) clumps_.drop_internal(pairs);
    return pairs;
  } catch (const std::invalid_argument& error) {
    throw PhysicsError("contact search", error.what(), "grains left the domain for good, or the step is too large");
  }
}

void DemEngine::external_forces(const StepContext& context) {
  const Vec gravity = options.gravity;
  const bool rotating = contact_options_.rotations;
#pragma omp parallel for schedule(static) num_threads(threads) if (threads > 1)
  for (std::size_t i = 0; i < grains_.size(); ++i) {
    motion.force[i] = splat(motion.mass[i]) * gravity;
    if (rotating) rotation_.torque[i] = Vec{};
  }
  boundary.add_loads(motion, context);
}

void DemEngine::surface_forces() {
  const bool rotating = contact_options_.rotations;
  if (!walls_.empty()) walls_.add_forces(grains_, past_step_, motion, rotation_, rotating);
  if (block_.present()) block_.add_forces(grains_, built_domain_, past_step_, motion, rotation_, rotating);
}

void DemEngine::contact_forces(std::size_t first, std::size_t last) {
  if (contact_options_.geometry == Geometry::updated)
    contact_.add(first, last, past_step_, grains_, motion, rotation_);
  else
    frozen_.add_forces(first, last, motion.displacement, rotation_.angle, motion.force, rotation_.torque,
                       contact_options_.rotations, threads);
}

/// Potentials change over a drift of dt_old by the mean force at both ends, the kinetic energy at t_n takes f_n over
/// dt_new: where the step changes, the discrete energy jumps by (dt_new - dt_old)/2 f_n . v(n-1/2), loads apart, whose
/// work is booked with dt_new.
void DemEngine::book_step_change(double dt) {
  if (!motion.measured || past_step_ == 0.0 || past_step_ == dt) return;
  double power = motion.power_before() - boundary.load_power_before();
  if (contact_options_.rotations) power += rotation_.power_before();
  if (block_.present()) power += block_.power_before(options.gravity);
  step_change_ -= 0.5 * (dt - past_step_) * power;
}

void DemEngine::drift(const StepContext& context) {
  motion.drift(context);
  if (contact_options_.rotations) rotation_.drift(context);
  if (!clumps_.empty()) clumps_.drift(context, motion);
  if (!walls_.empty()) walls_.drift(context.dt);
  if (block_.present()) block_.drift(context);
  past_step_ = context.dt;
  contact_.strain_rate = Vec{};
}

/// Springs follow the last drift at the next force evaluation: brings that forward, before velocities
/// are overwritten.
void DemEngine::finish_last_step() {
  if (past_step_ == 0.0) return;
  if (contact_options_.geometry == Geometry::updated) {
    refresh_contacts();
    surface_forces();
    contact_forces(0, grains_.size());
  }
  past_step_ = 0.0;
}

}  // namespace gabion::dem
