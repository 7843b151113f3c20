#include "dem_server/sponge.hpp"

#include <algorithm>
#include <stdexcept>
#include <string>

namespace gabion::dem {
namespace {

void check(const std::vector<std::int32_t>& grains, const std::vector<double>& beta, std::size_t hats,
           const std::vector<std::int32_t>& row_ptr, const std::vector<std::int32_t>& columns,
           const std::vector<double>& values, std::size_t points) {
  if (beta.size() != grains.size()) throw std::invalid_argument("beta needs one value per grain");
  if (row_ptr.size() != grains.size() + 1 || row_ptr.front() != 0 ||
      static_cast<std::size_t>(row_ptr.back()) != columns.size() || columns.size() != values.size() ||
      !std::is_sorted(row_ptr.begin(), row_ptr.end()))
    throw std::invalid_argument("row_ptr, columns and values do not fit together");
  for (const std::int32_t g : grains)
    if (g < 0 || static_cast<std::size_t>(g) >= points)
      throw std::out_of_range("grain " + std::to_string(g) + " of " + std::to_string(points));
  for (const std::int32_t c : columns)
    if (c < 0 || static_cast<std::size_t>(c) >= hats)
      throw std::out_of_range("hat " + std::to_string(c) + " of " + std::to_string(hats));
  for (const double b : beta)
    if (!(b >= 0.0 && b <= 1.0)) throw std::invalid_argument("beta " + std::to_string(b) + " is not in 0 to 1");
}

}  // namespace

void Sponge::set(std::vector<std::int32_t> grains, std::vector<double> beta, std::size_t hats,
                 const std::vector<std::int32_t>& row_ptr, const std::vector<std::int32_t>& columns,
                 const std::vector<double>& values, const engine::Motion& motion) {
  check(grains, beta, hats, row_ptr, columns, values, motion.size());
  grains_ = std::move(grains);
  beta_ = std::move(beta);
  reach_ = 0;
  for (const std::int32_t g : grains_) reach_ = std::max(reach_, static_cast<std::size_t>(g) + 1);
  if (grains_.empty()) return;

  const auto rows = static_cast<Eigen::Index>(grains_.size()), width = static_cast<Eigen::Index>(hats);
  std::vector<Eigen::Triplet<double>> entries, weighted;
  for (std::size_t p = 0; p < grains_.size(); ++p)
    for (std::int32_t k = row_ptr[p]; k < row_ptr[p + 1]; ++k) {
      entries.emplace_back(static_cast<int>(p), columns[k], values[k]);
      weighted.emplace_back(columns[k], static_cast<int>(p), motion.mass[grains_[p]] * beta_[p] * values[k]);
    }
  hats_.resize(rows, width);
  hats_.setFromTriplets(entries.begin(), entries.end());
  weighted_hats_.resize(width, rows);
  weighted_hats_.setFromTriplets(weighted.begin(), weighted.end());

  constexpr double regularisation = 1e-9;
  Eigen::SparseMatrix<double> normal = weighted_hats_ * hats_;
  std::vector<Eigen::Triplet<double>> diagonal;
  for (Eigen::Index h = 0; h < width; ++h) {
    const double d = normal.coeff(h, h);
    // a hat without damped grains carries nothing; any pivot will do
    diagonal.emplace_back(static_cast<int>(h), static_cast<int>(h), d > 0.0 ? regularisation * d : 1.0);
  }
  Eigen::SparseMatrix<double> added(width, width);
  added.setFromTriplets(diagonal.begin(), diagonal.end());
  normal += added;
  factor_ = std::make_unique<Eigen::SimplicialLLT<Eigen::SparseMatrix<double>>>(normal);
  if (factor_->info() != Eigen::Success)
    throw std::invalid_argument("the sponge's hats are not independent: its matrix has no factor");
  velocity_.resize(rows, 3);
  impulse_.assign(grains_.size(), Vec{});
}

void Sponge::absorb(engine::Motion& motion) {
  if (grains_.empty()) return;
  for (std::size_t p = 0; p < grains_.size(); ++p)
    for (int axis = 0; axis < 3; ++axis)
      velocity_(static_cast<Eigen::Index>(p), axis) = motion.velocity[grains_[p]][axis];
  carried_ = hats_ * factor_->solve(weighted_hats_ * velocity_);
  for (std::size_t p = 0; p < grains_.size(); ++p) {
    const auto row = static_cast<Eigen::Index>(p);
    const std::int32_t g = grains_[p];
    const Vec carried = vec(carried_(row, 0), carried_(row, 1), carried_(row, 2));
    const Vec change = splat(-beta_[p]) * motion.freedom[g] * (motion.velocity[g] - carried);
    motion.velocity[g] += change;
    // with dashpots, the impulse that has this effect is (m + c dt/2) dv
    const Vec mobility = motion.mobility[g];
    for (int axis = 0; axis < 3; ++axis) impulse_[p][axis] = mobility[axis] > 0.0 ? change[axis] / mobility[axis] : 0.0;
  }
}

void Sponge::book(const engine::Motion& motion) {
  if (!motion.measured) return;  // without grains too: the second half of the last step is still to be added
  double first = 0.0, second = 0.0;
  for (std::size_t p = 0; p < grains_.size(); ++p) {
    first += dot(impulse_[p], motion.old_velocity[grains_[p]]);
    second += dot(impulse_[p], motion.velocity[grains_[p]]);
  }
  work.add(0.5 * first, 0.5 * second);
}

}  // namespace gabion::dem
