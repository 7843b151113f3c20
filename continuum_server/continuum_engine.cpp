#include "continuum_server/continuum_engine.hpp"

#include <algorithm>
#include <cmath>
#include <string>

#include "continuum_server/denormals.hpp"
#include "continuum_server/stable_step.hpp"

namespace gabion::continuum {

using engine::Exchange;
using engine::Ledger;
using engine::PhysicsError;
using engine::RequestError;
using engine::StepContext;

void ContinuumEngine::set_mesh(Mesh mesh) {
  mesh_ = std::move(mesh);
  motion.resize(mesh_.nodes.size(), options.measure_energy);
  motion.position = mesh_.nodes;
  boundary = engine::Boundary{};
  tie.clear();
  past_step_ = step_change_ = rate_swing_ = 0.0;
  rates_ = one_rate(mesh_.nodes.size());
  prepared_ = false;
}

void ContinuumEngine::set_materials(std::vector<SolidMaterial> materials) {
  materials_ = std::move(materials);
  prepared_ = false;
}

void ContinuumEngine::prepare() {
  phase = "building elements";
  for (std::size_t m = 0; m < materials_.size(); ++m) check(materials_[m], m);
  check(mesh_, materials_.size());
  check_shapes();
  weigh_elements();
  sum_masses();
  add_body_loads();
  forces_.build(mesh_, materials_, share_, edges());
  forces_.set_rates(rates_);
  forces_.arrange(0, 1);
  boundary.apply_to(motion);
  motion.threads = threads;
  motion.measured = options.measure_energy;
  motion.old_velocity.resize(motion.measured ? motion.size() : 0, Vec{});
  motion.damping_force.resize(motion.measured ? motion.size() : 0, Vec{});
  step_size_ = 0.0;
  reach_ = 0;
  arranged_threads_ = 1;
  prepared_ = true;
  phase = "idle";
}

double ContinuumEngine::stable_step() {
  if (!prepared_) throw RequestError("STABLE_STEP", "the engine is not prepared", "send PREPARE first");
  phase = "finding the stable step";
  boundary.apply_to(motion);
  step_size_ = 0.0;
  const double squared = largest_squared_frequency(motion, [&](const VecField& u, VecField& force) {
    forces_.start({}, force);
    if (rates_.several()) return forces_.subtract_squared(u, force);
    forces_.subtract(Part::interface, u, force);
    forces_.subtract(Part::interior, u, force);
  });
  phase = "idle";
  return squared > 0.0 ? 2.0 / std::sqrt(squared) : INFINITY;
}

bool ContinuumEngine::step(const StepContext& context, Exchange& exchange) {
  const bool tied = tie.mode() != engine::Tie::Mode::none;
  const std::size_t reach = tie.reach(), nodes = motion.size();
  adapt(context);
  time_ = context.time;
  if (rates_.several()) return step_at_rates(context, exchange);

  forces_.start(body_, motion.force);
  forces_.subtract(Part::interface, motion.displacement, motion.force);
  boundary.add_loads(motion, context);
  motion.trial(0, reach, context);
  boundary.prescribe(motion, context, 0, reach);
  if (tied) exchange.send_gap(tie.project(motion, context));

  forces_.subtract(Part::interior, motion.displacement, motion.force);
  motion.trial(reach, nodes, context);
  boundary.prescribe(motion, context, reach, nodes);

  const bool more = !tied || exchange.receive_multipliers(tie.answer_buffer());
  if (tied) tie.correct(motion, context);
  boundary.book(motion, context);
  book_step_change(context.dt);
  if (context.measure) measure_stored_energy();
  motion.drift(context);
  if (context.measure || !motion.finite) check_health();
  return more;
}

void ContinuumEngine::adapt(const StepContext& context) {
  flush_denormals();
  if (reach_ != tie.reach() || arranged_threads_ != threads) {
    check_margin(rates_, mesh_, tie.reach());
    reach_ = tie.reach();
    motion.threads = arranged_threads_ = threads;
    forces_.arrange(reach_, threads);
    std::fill(motion.tie_force.begin() + static_cast<long>(reach_), motion.tie_force.end(), Vec{});
  }
  if (step_size_ != context.dt) {
    step_size_ = context.dt;
    motion.set_step(context.dt);
  }
}

/// As DemEngine does: where the step changes the discrete energy jumps by (dt_new - dt_old)/2 f_n . v(n-1/2), loads apart.
void ContinuumEngine::book_step_change(double dt) {
  if (motion.measured && past_step_ != 0.0 && past_step_ != dt)
    step_change_ -= 0.5 * (dt - past_step_) * (motion.power_before() - boundary.load_power_before());
  past_step_ = dt;
}

void ContinuumEngine::measure_stored_energy() {
  if (!motion.measured) return;
  kinetic_ = motion.kinetic_energy();
  elastic_ = forces_.energy(motion.displacement);
  gravity_ = 0.0;
  for (std::size_t n = 0; n < body_.size(); ++n) gravity_ -= engine::dot(body_[n], motion.displacement[n]);
}

void ContinuumEngine::check_health() const {
  if (!std::isfinite(motion.largest_speed())) {
    std::size_t n = 0;
    while (std::isfinite(engine::sum(motion.velocity[n]))) ++n;
    throw PhysicsError("node " + std::to_string(n), "the velocity is not a finite number",
                       "use a smaller step, and check loads and materials near this node");
  }
  for (std::size_t e = 0; e < mesh_.elements.size(); ++e)
    if (!(smallest_corner_jacobian(corners_now(e)) > 0.0))
      throw PhysicsError("element " + std::to_string(e), "the element has turned inside out",
                         "displacements are beyond small ones here: use a smaller load or a larger DEM zone");
}

Corners ContinuumEngine::corners_now(std::size_t element) const {
  return corners_of(mesh_, element, edges(), &motion.displacement);
}

Ledger ContinuumEngine::ledger() const {
  Ledger ledger;
  ledger.add("kinetic", Ledger::Kind::stored, kinetic_);
  ledger.add("elastic", Ledger::Kind::stored, elastic_);
  ledger.add("gravity", Ledger::Kind::stored, gravity_);
    ledger.add("damping", Ledger::Kind::lost, -motion.damping_work.until_now());
  ledger.add("dashpots", Ledger::Kind::lost, -motion.dashpot_work.until_now());
  ledger.add("step_change", Ledger::Kind::lost, step_change_);
  ledger.add("loads", Ledger::Kind::work, boundary.load_work.until_now());
  ledger.add("constraints", Ledger::Kind::work, boundary.constraint_work.until_now());
  ledger.add("multipliers", Ledger::Kind::work, tie.work.until_now());
  ledger.add("rate_swing", Ledger::Kind::aside, rate_swing_);
  return ledger;
}

std::vector<engine::NamedCount> ContinuumEngine::counters() const {
  return {{"nodes", static_cast<double>(motion.size())},
          {"elements", static_cast<double>(mesh_.elements.size())},
          {"bricks", static_cast<double>(forces_.bricks())},
          {"distorted", static_cast<double>(forces_.distorted())}};
}

double ContinuumEngine::unbalanced() const {
  const double mean = rates_.several() ? motion.mean_unbalanced_force(present_forces()) : motion.mean_unbalanced_force();
  return mean == 0.0 ? 0.0 : mean / forces_.mean_corner_force(motion.displacement);
}

}  // namespace gabion::continuum
