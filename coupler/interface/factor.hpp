#pragma once
// Sparse Cholesky (LDL^T) of a symmetric positive matrix, applied to three right-hand sides at once.

#include <Eigen/Dense>
#include <Eigen/Sparse>
#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace gabion::coupler {

using Triple = std::array<double, 3>;

/// Factored once, solved every step without allocation. When the matrix is singular to round-off (more
/// multipliers than the grains can carry) the pseudo-inverse of a dense eigen decomposition takes over: the
/// answer is then the least multiplier that closes every gap that can be closed.
class Factor {
 public:
  using Matrix = Eigen::SparseMatrix<double>;

  Factor() = default;
  /// Throws std::runtime_error when the matrix is singular and too large for the dense form.
  explicit Factor(const Matrix& matrix);

  /// b := A^-1 b, for all three components.
  void solve(std::span<Triple> b) const;

  std::size_t size() const { return size_; }
  std::size_t rank() const { return rank_; }
  std::size_t nonzeros() const { return rows_.size() + size_; }
  /// Largest over smallest (nonzero) eigenvalue, by power iteration; within some per cent.
  double condition() const { return condition_; }

 private:
  void estimate_condition(const Matrix& matrix);
  void take_pseudo_inverse(const Matrix& matrix);

  std::size_t size_ = 0, rank_ = 0;
  double condition_ = 1.0;
  std::vector<std::int32_t> column_ptr_, rows_, order_;  ///< unit lower triangle by columns; order_[new] = old
  std::vector<double> values_, pivots_;
  Eigen::MatrixXd pseudo_inverse_;
  mutable std::vector<Triple> work_;
};

}  // namespace gabion::coupler
