#include "coupler/interface/factor.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>

namespace gabion::coupler {

namespace {

constexpr double singular = 1e-13;             // pivot over largest pivot, below which the matrix counts as singular
constexpr double negligible_eigenvalue = 1e-11;  // of the largest; left out of the pseudo-inverse
constexpr int power_iterations = 60;
constexpr std::size_t largest_dense = 6000;

Triple operator-(const Triple& a, const Triple& b) { return {a[0] - b[0], a[1] - b[1], a[2] - b[2]}; }
Triple operator*(double s, const Triple& a) { return {s * a[0], s * a[1], s * a[2]}; }

}  // namespace

Factor::Factor(const Matrix& matrix) : size_(static_cast<std::size_t>(matrix.rows())), rank_(size_) {
  work_.resize(size_);
  if (size_ == 0) return;
  Eigen::SimplicialLDLT<Matrix> ldlt(matrix);
  const auto pivots = ldlt.vectorD();
  const double largest = pivots.size() ? pivots.cwiseAbs().maxCoeff() : 0.0;
  const bool sound = ldlt.info() == Eigen::Success && pivots.allFinite() && pivots.minCoeff() > singular * largest;
  if (!sound) {
    take_pseudo_inverse(matrix);
    return;
  }
  const Matrix lower = ldlt.matrixL();
  column_ptr_.assign(size_ + 1, 0);
  for (int column = 0; column < lower.outerSize(); ++column) {
    for (Matrix::InnerIterator it(lower, column); it; ++it)
      if (it.row() > column) {
        rows_.push_back(static_cast<std::int32_t>(it.row()));
        values_.push_back(it.value());
      }
    column_ptr_[column + 1] = static_cast<std::int32_t>(rows_.size());
  }
  pivots_.assign(pivots.data(), pivots.data() + pivots.size());
  order_.resize(size_);
  const auto& permutation = ldlt.permutationP().indices();
  for (std::size_t old = 0; old < size_; ++old) order_[permutation.size() ? permutation[old] : old] = static_cast<std::int32_t>(old);
  estimate_condition(matrix);
}

void Factor::solve(std::span<Triple> b) const {
  if (pseudo_inverse_.size() > 0) {
    Eigen::Map<Eigen::Matrix<double, Eigen::Dynamic, 3, Eigen::RowMajor>> rows(b.data()->data(), static_cast<long>(size_), 3);
    const Eigen::Matrix<double, Eigen::Dynamic, 3, Eigen::RowMajor> solved = pseudo_inverse_ * rows;
    rows = solved;
    return;
  }
  for (std::size_t i = 0; i < size_; ++i) work_[i] = b[order_[i]];
  for (std::size_t c = 0; c < size_; ++c)
    for (std::int32_t k = column_ptr_[c]; k < column_ptr_[c + 1]; ++k) work_[rows_[k]] = work_[rows_[k]] - values_[k] * work_[c];
  for (std::size_t i = 0; i < size_; ++i) work_[i] = (1.0 / pivots_[i]) * work_[i];
  for (std::size_t c = size_; c-- > 0;)
    for (std::int32_t k = column_ptr_[c]; k < column_ptr_[c + 1]; ++k) work_[c] = work_[c] - values_[k] * work_[rows_[k]];
  for (std::size_t i = 0; i < size_; ++i) b[order_[i]] = work_[i];
}

void Factor::estimate_condition(const Matrix& matrix) {
  Eigen::VectorXd x = Eigen::VectorXd::LinSpaced(static_cast<long>(size_), 1.0, 2.0);
  for (long i = 1; i < x.size(); i += 2) x[i] = -x[i];
  Eigen::VectorXd y = x;
  double largest = 0.0, smallest_inverse = 0.0;
  std::vector<Triple> column(size_);
  for (int sweep = 0; sweep < power_iterations; ++sweep) {
    x.normalize();
    x = matrix.selfadjointView<Eigen::Lower>() * x;
    largest = x.norm();
    y.normalize();
    for (std::size_t i = 0; i < size_; ++i) column[i] = {y[static_cast<long>(i)], 0.0, 0.0};
    solve(column);
    for (std::size_t i = 0; i < size_; ++i) y[static_cast<long>(i)] = column[i][0];
    smallest_inverse = y.norm();
  }
  condition_ = largest * smallest_inverse;
}

void Factor::take_pseudo_inverse(const Matrix& matrix) {
  if (size_ > largest_dense)
    throw std::runtime_error("the multiplier matrix of " + std::to_string(size_) +
                             " rows is singular: more multipliers than the grains can carry; use rows mortar2h or a "
                             "larger mesh.size");
  const Eigen::MatrixXd dense = Eigen::MatrixXd(matrix).selfadjointView<Eigen::Lower>();
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(dense);
  const double limit = negligible_eigenvalue * eigen.eigenvalues().maxCoeff();
  Eigen::VectorXd inverse = Eigen::VectorXd::Zero(dense.rows());
  rank_ = 0;
  double smallest = eigen.eigenvalues().maxCoeff();
  for (long i = 0; i < inverse.size(); ++i)
    if (eigen.eigenvalues()[i] > limit) {
      inverse[i] = 1.0 / eigen.eigenvalues()[i];
      smallest = std::min(smallest, eigen.eigenvalues()[i]);
      ++rank_;
    }
  condition_ = rank_ == 0 ? 0.0 : eigen.eigenvalues().maxCoeff() / smallest;
  pseudo_inverse_ = eigen.eigenvectors() * inverse.asDiagonal() * eigen.eigenvectors().transpose();
}

}  // namespace gabion::coupler
