#include "coupler/run/stepper.hpp"

#include <cmath>

#include "coupler/run/run_failed.hpp"

namespace gabion::coupler {

namespace {

using Clock = std::chrono::steady_clock;

double seconds_since(Clock::time_point& last) {
  const Clock::time_point now = Clock::now();
  const double passed = std::chrono::duration<double>(now - last).count();
  last = now;
  return passed;
}

}  // namespace

Advance Stepper::advance(std::uint64_t steps, double dt, double damping, std::uint64_t measure) {
  Clock::time_point begin = Clock::now();
  const std::uint64_t bytes_before = tie_ ? dem_->bytes() + continuum_->bytes() : 0;
  protocol::Run run;
  run.steps = steps;
  run.first_step = step_;
  run.time = time_;
  run.dt = dt;
  run.damping = damping;
  run.measure = static_cast<std::uint8_t>(measure);
  if (dem_) dem_->start(run);
  if (continuum_) continuum_->start(run);

  if (tie_)
    for (std::uint64_t k = 0; k < steps; ++k, ++step_) tie_one_step();
  else
    step_ += steps;

  Advance advance;
  advance.ledger_age = static_cast<double>(measure);
  if (dem_) advance.dem = dem_->finish();
  if (continuum_) advance.continuum = continuum_->finish();
  time_ += static_cast<double>(steps) * dt;
  if (tie_) times_.bytes += dem_->bytes() + continuum_->bytes() - bytes_before;
  times_.steps += steps;
  times_.total += seconds_since(begin);
  return advance;
}

/// Stops here what would be everywhere one solve later, and could not be told apart then.
void Stepper::check_gap(std::span<const double> gap, const EngineLink& link) const {
  double nothing = 0.0;
  for (const double value : gap) nothing += 0.0 * value;  // not a number where one of them is none
  if (nothing == 0.0) return;
  std::size_t k = 0;
  while (std::isfinite(gap[k])) ++k;
  const Point& at = tie_->rows().slot_position[k / 3];
  const Point origin = tie_->scene_origin();
  std::string place;
  for (std::size_t axis = 0; axis < 3; ++axis) place += (axis ? ", " : "") + std::to_string(at[axis] + origin[axis]);
  throw RunFailed("step " + std::to_string(step_) + ": " + link.role() + "_server sent " + std::to_string(gap[k]) + " as component " +
                  "xyz"[k % 3] + " of GAP row " + std::to_string(k / 3) + " of the interface, at (" + place +
                  ") m: the motion of the grains or nodes around it is no number");
}

/// Gap from both, multipliers to both; the engines compute their interior meanwhile.
void Stepper::tie_one_step() {
  Clock::time_point last = Clock::now();
  const std::span<const double> from_grains = dem_->receive_gap(tie_->slots(), step_);
  check_gap(from_grains, *dem_);
  times_.waiting_dem += seconds_since(last);
  const std::span<const double> from_nodes = continuum_->receive_gap(tie_->slots(), step_);
  check_gap(from_nodes, *continuum_);
  times_.waiting_continuum += seconds_since(last);
  const std::span<const double> answer = tie_->solve(from_grains, from_nodes);
  times_.solving += seconds_since(last);
  dem_->send_multipliers(answer, false, step_);
  continuum_->send_multipliers(answer, false, step_);
}

}  // namespace gabion::coupler
