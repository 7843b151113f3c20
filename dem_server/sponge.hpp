#pragma once
// Damps the part of the grains' trial velocity that the multiplier mesh cannot carry; see SPONGE in
// PROTOCOL.md.
//
//   e = v* - Phi (Phi^T B Phi + 1e-9 diag)^-1 Phi^T B v*,   v* -= beta e,   B = diag(m beta)
//
//   m     weighted mass [kg]      beta  damping share per step      Phi  the mesh's hats at the grains

#include <Eigen/Sparse>
#include <cstdint>
#include <memory>
#include <vector>

#include "dem_server/neighbours.hpp"
#include "protocol/engine/motion.hpp"

namespace gabion::dem {

class Sponge {
 public:
  /// CSR rows of Phi, one per grain. No grains: no sponge. Throws std::invalid_argument or
  /// std::out_of_range with what is wrong.
  void set(std::vector<std::int32_t> grains, std::vector<double> beta, std::size_t hats,
           const std::vector<std::int32_t>& row_ptr, const std::vector<std::int32_t>& columns,
           const std::vector<double>& values, const engine::Motion& motion);

  bool empty() const { return grains_.empty(); }
  /// Every damped grain has an index below this.
  std::size_t reach() const { return reach_; }

  /// Damps the trial velocities.
  void absorb(engine::Motion& motion);
  /// Books the work of the last absorb as that of a force; call when velocities are final.
  void book(const engine::Motion& motion);

  engine::Work work;  ///< negative or zero, J

 private:
  std::vector<std::int32_t> grains_;
  std::vector<double> beta_;
  std::size_t reach_ = 0;
  Eigen::SparseMatrix<double, Eigen::RowMajor> hats_, weighted_hats_;  // Phi; (B Phi)^T
  // the factor cannot be copied
  std::unique_ptr<Eigen::SimplicialLLT<Eigen::SparseMatrix<double>>> factor_;
  Eigen::MatrixXd velocity_, carried_;
  VecField impulse_;  ///< kg m/s
};

}  // namespace gabion::dem
