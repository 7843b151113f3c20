#pragma once
// Static equilibrium of a bonded packing by preconditioned conjugate gradients, without a matrix.
//
//   delta = w_j - w_i - (a_i theta_i + a_j theta_j) x n + E.branch      relative motion at the contact, m
//   F     = k_n (delta.n) n + k_s (delta - (delta.n) n)                 force on i (-F on j), N
//   T_i   = a_i n x F,   T_j = a_j n x F                                torques, N m
//
//   w      displacement beyond the affine field E.x, m     theta  rotation
//   E      macroscopic strain (symmetric)                  n      normal from i to j
//
// Hestenes and Stiefel (1952); preconditioner: the inverse of each grain's own 6 x 6 block, where its
// eigenvalues are not zero (grains without bonds, or rotations without shear stiffness, stay put).

#include <Eigen/Dense>
#include <cstdint>
#include <vector>

#include "dem_server/packing/bond_network.hpp"

namespace gabion::dem {

/// Per grain: displacement w [m], then rotation times the mean radius [m].
using GrainMotion = VecField;

struct SolveLimits {
  double residual = 1e-10;  ///< relative, of forces and of torques over the mean radius
  int iterations = 20000;
};

struct SolveOutcome {
  int iterations = 0;
  double residual = 0.0;  ///< reached
  bool converged = true;
};

/// Bits of what is fixed of a grain; as in the message CONSTRAIN.
constexpr std::uint8_t rotations_fixed = 8, all_fixed = 15;

class Equilibrium {
 public:
  /// fixed: bits x = 1, y = 2, z = 4 of the displacements that are prescribed, 8 for no rotation. They keep the affine
  /// displacement, plus `beyond` [m] where it is given, one entry a grain. Where none is fixed (periodic in all
  /// directions) the mean displacement is kept at zero.
  Equilibrium(const BondNetwork& network, std::vector<std::uint8_t> fixed, VecField beyond = {});

  /// Solves for the macroscopic strain; motion is the start and becomes the answer (resized if need be).
  SolveOutcome solve(const Eigen::Matrix3d& strain, const SolveLimits& limits, GrainMotion& motion) const;

  /// Force on grain i of a bond for a motion and strain, N.
  Vec bond_force(std::size_t bond, const Eigen::Matrix3d& strain, const GrainMotion& motion) const;

  const BondNetwork& network() const { return network_; }

 private:
  /// out := internal forces and torques over the mean radius that resist the motion, zero where fixed.
  void resist(const GrainMotion& motion, GrainMotion& out) const;
  void load(const Eigen::Matrix3d& strain, GrainMotion& out) const;
  void precondition(const GrainMotion& residual, GrainMotion& out) const;
  /// Zero where fixed.
  void settle(GrainMotion& field) const;
  Vec free_components(std::size_t grain) const;
  void factor_blocks();

  /// A bond with lengths over the mean radius.
  struct Spring {
    Vec normal;
    double a_i, a_j, k_n, k_s;
    std::int32_t i, j;
  };
  Vec spring_force(const Spring& spring, const GrainMotion& motion) const;
  void apply(const Spring& spring, Vec force, GrainMotion& out) const;

  const BondNetwork& network_;
  std::vector<std::uint8_t> fixed_;
  bool turns(std::size_t grain) const { return network_.locked.empty() || !network_.locked[grain]; }

  VecField beyond_;
  bool floating_ = true;
  double mean_radius_ = 0.0;
  std::vector<Spring> springs_;
  std::vector<double> inverse_blocks_;  ///< [grains][6][6]
};

}  // namespace gabion::dem
