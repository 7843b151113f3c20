#pragma once
// The part of an explicit engine that does not know what a contact or an element is: points with
// mass, displacement and velocity, advanced by leapfrog.
//
//   v(n+1/2) = v(n-1/2) + dt m^-1 (f_n - c v_mid - alpha |f_n + t_(n-1)| sign(v(n-1/2))),   u(n+1) = u(n) + dt v(n+1/2)
//
//   m     weighted mass [kg]            f   total force without tie and damping [N]
//   c     dashpot viscosity [N s/m], implicit: v_mid = (v(n-1/2) + v(n+1/2))/2
//   alpha local damping coefficient     t   force of the multipliers in the last step [N]
//
// Local damping after Cundall (1987), with the total force; see docs/theory.md.

#include <cstdint>
#include <string>
#include <vector>

#include "protocol/engine/vec.hpp"

namespace gabion::engine {

/// What a step needs to know.
struct StepContext {
  double time = 0.0;     ///< t_n, s
  double dt = 0.0;       ///< step, s
  double damping = 0.0;  ///< local damping coefficient, 0 to below 1
  bool measure = false;  ///< evaluate the ledger in this step
  std::uint64_t step = 0;  ///< n; only engines with points of several rates look at it
};

/// Points that take steps of their own, rate times that of the run. See Motion::tiers.
struct Tier {
  std::size_t first = 0, last = 0;  ///< points [first, last)
  std::uint64_t rate = 1;           ///< a power of two

  /// The tier's own step, at a step of the run that is a multiple of the rate.
  StepContext own(const StepContext& context) const {
    StepContext longer = context;
    longer.dt = static_cast<double>(rate) * context.dt;
    return longer;
  }
};

/// Work of a force over leapfrog steps, in the two halves that make the discrete energy exact: at t_n
/// the first half F_n . v(n-1/2) dt/2 has been done, the second half F_n . v(n+1/2) dt/2 has not.
/// Tiers add theirs at their own steps; the sum belongs to one time when all of them have just done so.
class Work {
 public:
  static constexpr std::size_t most_tiers = 8;

  void add(double first_half, double second_half, std::size_t tier = 0) {
    done_ += pending_[tier] + first_half;
    pending_[tier] = second_half;
  }
  double until_now() const { return done_; }  ///< J, up to t_n of the last step added
  /// Before the points change their tiers: what is pending is added with the next of tier 0.
  void merge_tiers() {
    for (std::size_t tier = 1; tier < most_tiers; ++tier) {
      pending_[0] += pending_[tier];
      pending_[tier] = 0.0;
    }
  }

 private:
  double done_ = 0.0;
  double pending_[most_tiers] = {};
};

struct Motion {
  // State, one entry a point
  VecField position;      ///< at rest, m
  VecField displacement;  ///< from rest, m
  VecField velocity;      ///< v(n-1/2), then trial, then v(n+1/2), m/s
  VecField force;         ///< internal, body and load forces at t_n, N
  VecField tie_force;     ///< force of the multipliers in the last step, N; zero where not tied

  // Fixed during a run
  std::vector<double> mass;        ///< weighted, kg
  std::vector<double> plain_mass;  ///< without weights, kg
  VecField viscosity;              ///< dashpots, N s/m; empty when there are none
  VecField freedom;                ///< 1 where a component is free, 0 where prescribed
  VecField mobility;               ///< freedom/(m + c dt/2), 1/kg; see set_step

  // Kept only when the ledger is on (measured), else empty
  VecField old_velocity;   ///< v(n-1/2)
  VecField damping_force;  ///< local damping force at t_n, N

  /// Points of different rates, the finest first; empty: all take every step. A tier takes part in the steps whose number
  /// is a multiple of its rate, and then moves by its whole own step.
  std::vector<Tier> tiers;

  bool measured = false;
  bool finite = true;  ///< of the velocities in the last drift
  int threads = 1;
  Work damping_work;  ///< of local damping (negative or zero), J
  Work dashpot_work;  ///< of dashpots (negative or zero), J

  std::size_t size() const { return position.size(); }

  /// Sizes every array for n points at rest.
  void resize(std::size_t n, bool measure_energy);

  /// Prepares mobility for a step size; call when dt, masses, viscosity, freedom or tiers change.
  void set_step(double dt);

  /// velocity := trial velocity of points [first, last). Prescribed components are left alone.
  void trial(std::size_t first, std::size_t last, const StepContext& context);

  /// u += dt v for all points, and says in finite whether each v is a number; with the ledger on, books the work of
  /// damping and dashpots first.
  void drift(const StepContext& context) { drift(context, 0, size(), 0); }
  /// The same for the points [first, last) of a tier, context being the tier's own.
  void drift(const StepContext& context, std::size_t first, std::size_t last, std::size_t tier);

  /// sum of 1/2 v(n-1/2) m v(n+1/2), J; needs measured.
  double kinetic_energy() const;
  /// sum of f_n . v(n-1/2), W; needs measured, before the drift.
  double power_before() const;

  /// Linear momentum (3), angular momentum about the origin (3), sum of m |v| (1).
  std::vector<double> momentum() const;

  /// Largest |v|, m/s, and whether every velocity is finite.
  double largest_speed() const;

  /// Mean over points of |total force|, multipliers included, free components only, N.
  double mean_unbalanced_force() const { return mean_unbalanced_force(force); }
  double mean_unbalanced_force(const VecField& forces) const;

 private:
  void set_step(double dt, std::size_t first, std::size_t last);
};

}  // namespace gabion::engine
