#pragma once
// Rotations of the grains, advanced by the same leapfrog as Motion.
//
//   omega(n+1/2) = omega(n-1/2) + dt I^-1 (T - alpha |T| sign(omega(n-1/2))),   theta(n+1) = theta(n) + dt omega(n+1/2)
//
//   I      weighted inertia 2/5 m r^2 [kg m2]; a sphere has no gyroscopic term
//   T      torque of the contacts at t_n [N m]
//   alpha  local damping coefficient

#include "dem_server/neighbours.hpp"
#include "protocol/engine/motion.hpp"

namespace gabion::dem {

struct Rotation {
  VecField angle;                ///< sum of spin dt, rad
  VecField spin;                 ///< omega(n-1/2), then omega(n+1/2), rad/s
  VecField torque;               ///< N m
  std::vector<double> inertia;   ///< weighted, kg m2
  std::vector<double> mobility;  ///< 1/I, or 0 where the rotation is held, 1/(kg m2)
  VecField old_spin;             ///< omega(n-1/2); kept only when measured
  VecField damping_torque;       ///< kept only when measured, N m
  bool measured = false;
  bool finite = true;            ///< of the spins in the last drift
  int threads = 1;
  engine::Work damping_work;  ///< J

  std::size_t size() const { return angle.size(); }
  void resize(std::size_t n);
  /// Allocates what the ledger needs.
  void set_measured(bool on);

  void trial(const engine::StepContext& context);
  /// Books the work of damping, then turns; says in finite whether each spin is a number.
  void drift(const engine::StepContext& context);

  /// sum of 1/2 omega(n-1/2) I omega(n+1/2), J; needs measured.
  double kinetic_energy() const;
  /// sum of T_n . omega(n-1/2), W; needs measured, before the drift.
  double power_before() const;
  /// sum of I omega, kg m2/s.
  Vec momentum() const;
};

}  // namespace gabion::dem
