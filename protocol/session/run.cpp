// RUN: steps, exchange, and the summary that ends it.

#include <cmath>

#include "protocol/session/exchange.hpp"
#include "protocol/session/service.hpp"

namespace gabion::protocol {

namespace {

using engine::RequestError;

void check(const Run& request, const engine::Engine& engine) {
  const auto refuse = [](const char* field, double value, const char* expected) {
    throw RequestError(std::string("RUN.") + field, "it is " + std::to_string(value), std::string("send ") + expected);
  };
  if (request.steps == 0) refuse("steps", 0, "1 or more");
  if (!(std::isfinite(request.dt) && request.dt > 0.0)) refuse("dt", request.dt, "a finite step above 0");
  if (!std::isfinite(request.time)) refuse("time", request.time, "a finite time");
  if (!(request.damping >= 0.0 && request.damping < 1.0)) refuse("damping", request.damping, "0 to below 1");
  if (request.measure > request.steps) refuse("measure", request.measure, "at most the number of steps");
  if (request.measure != 0 && !engine.options.measure_energy)
    throw RequestError("RUN.measure", "the engine keeps no energy ledger", "set OPTIONS.measure_energy before PREPARE");
  const std::uint64_t period = engine.period();
  if (period == 1) return;
  const std::string whole = "a multiple of the largest of RATES, " + std::to_string(period);
  if (request.steps % period != 0) refuse("steps", static_cast<double>(request.steps), whole.c_str());
  if (request.first_step % period != 0) refuse("first_step", static_cast<double>(request.first_step), whole.c_str());
  if (request.measure % period != 0) refuse("measure", request.measure, whole.c_str());
  if (request.damping > 0.0) refuse("damping", request.damping, "0 while RATES are above 1");
}

}  // namespace

RunDone Service::run(const Run& request) {
  check(request, engine_);
  if (run_failed_)
    throw RequestError("RUN", "the last run failed inside step " + std::to_string(engine_.current_step),
                       "RESTORE a state or PREPARE again");
  engine_.boundary.apply_to(engine_.motion);
  engine_.motion.set_step(request.dt);
  engine_.probes.sampled_steps.clear();
  engine_.probes.samples.clear();
  std::uint64_t taken = 0;
  state_ = SessionState::running;
  try {
    const std::optional<engine::Ledger> ledger = take_steps(request, taken);
    RunDone done = summary(request, taken, ledger);
    state_ = SessionState::ready;
    return done;
  } catch (...) {
    state_ = SessionState::ready;
    run_failed_ = true;
    throw;
  }
}

/// Leaves the number of steps in taken; returns the ledger of the step that was to be measured.
std::optional<engine::Ledger> Service::take_steps(const Run& request, std::uint64_t& taken) {
  std::optional<engine::Ledger> ledger;
  ConnectionExchange exchange(*connection_, engine_, options_.exchange_timeout);
  engine::StepContext context{.time = request.time, .dt = request.dt, .damping = request.damping};
  try {
    while (taken < request.steps) {
      const std::uint64_t step = request.first_step + taken;
      engine_.current_step = step;
      context.time = request.time + static_cast<double>(taken) * request.dt;
      context.measure = request.measure != 0 && taken + request.measure == request.steps;
      context.step = step;
      engine_.probes.sample_if_due(step, engine_.motion);
      const bool go_on = engine_.step(context, exchange);
      if (context.measure) ledger = engine_.ledger();
      ++taken;
      if (!go_on) break;
      if (heartbeats_->peer_is_gone())
        throw ConnectionLost(connection_->peer(), "sending HEARTBEAT", step, "the connection is lost");
    }
  } catch (...) {
    multipliers_expected_ = exchange.answer_is_due();
    throw;
  }
  engine_.current_step = request.first_step + taken;
  return ledger;
}

RunDone Service::summary(const Run& request, std::uint64_t taken, const std::optional<engine::Ledger>& ledger) {
  RunDone done;
  done.step = request.first_step + taken;
  done.time = request.time + static_cast<double>(taken) * request.dt;
  engine_.check_health();
  done.largest_speed = engine_.motion.largest_speed();
  if (!std::isfinite(done.largest_speed))
    throw engine::PhysicsError("velocity", "a velocity is not finite", "take a smaller step");
  done.unbalanced = engine_.unbalanced();
  done.largest_displacement = engine_.tie.largest_displacement(engine_.motion);
  if (ledger) {
    std::vector<double> energies;
    std::vector<std::uint8_t> kinds;
    for (const auto& entry : ledger->entries) {
      done.ledger_names.push_back(entry.name);
      energies.push_back(entry.energy);
      kinds.push_back(static_cast<std::uint8_t>(entry.kind));
    }
    done.ledger = std::move(energies);
    done.ledger_kinds = std::move(kinds);
  }
  std::vector<double> counts;
  for (const auto& counter : engine_.counters()) {
    done.counter_names.push_back(counter.name);
    counts.push_back(counter.value);
  }
  done.counters = std::move(counts);
  done.reaction_names = engine_.boundary.constraint_names();
  done.reactions = engine_.boundary.reactions();
  engine::Probes& probes = engine_.probes;
  done.probes.set_shape(std::array<std::uint64_t, 3>{probes.sampled_steps.size(), probes.names.size(), 3});
  done.probe_steps = std::move(probes.sampled_steps);
  done.probes.data = std::move(probes.samples);
  done.momentum = engine_.momentum();
  done.state_hash = engine_.state_hash();
  return done;
}

}  // namespace gabion::protocol
