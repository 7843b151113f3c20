#include "protocol/engine/tie.hpp"

#include <algorithm>
#include <stdexcept>

namespace gabion::engine {

namespace {

/// Transpose of a CSR matrix: entries of column c are rows[ptr[c] .. ptr[c+1]), in row order.
void transpose(std::size_t column_count, const std::vector<std::int32_t>& row_ptr,
               const std::vector<std::int32_t>& columns, const std::vector<double>& values,
               std::vector<std::int32_t>& ptr, std::vector<std::int32_t>& rows, std::vector<double>& out) {
  ptr.assign(column_count + 1, 0);
  for (const std::int32_t c : columns) ++ptr[c + 1];
  for (std::size_t c = 0; c < column_count; ++c) ptr[c + 1] += ptr[c];
  rows.resize(columns.size());
  out.resize(columns.size());
  std::vector<std::int32_t> next(ptr.begin(), ptr.end() - 1);
  for (std::size_t r = 0; r + 1 < row_ptr.size(); ++r)
    for (std::int32_t k = row_ptr[r]; k < row_ptr[r + 1]; ++k) {
      const std::int32_t place = next[columns[k]]++;
      rows[place] = static_cast<std::int32_t>(r);
      out[place] = values[k];
    }
}

Vec load(const double* p) { return vec(p[0], p[1], p[2]); }

void store(double* p, Vec a) {
  p[0] = a[0];
  p[1] = a[1];
  p[2] = a[2];
}

}  // namespace

void Tie::set(Mode mode, std::size_t slots, std::vector<std::int32_t> tied,
              std::vector<std::int32_t> row_ptr, std::vector<std::int32_t> columns,
              std::vector<double> values, const Motion& motion) {
  const std::size_t rows = mode == Mode::slave ? tied.size() : slots;
  if (row_ptr.size() != rows + 1 || row_ptr.front() != 0 ||
      static_cast<std::size_t>(row_ptr.back()) != columns.size() || columns.size() != values.size())
    throw std::invalid_argument("row_ptr, columns and values do not fit together");
  for (std::size_t r = 0; r < rows; ++r)
    if (row_ptr[r] > row_ptr[r + 1]) throw std::invalid_argument("row_ptr decreases at row " + std::to_string(r));
  const std::size_t column_limit = mode == Mode::slave ? slots : motion.size();
  for (const std::int32_t c : columns)
    if (c < 0 || static_cast<std::size_t>(c) >= column_limit)
      throw std::out_of_range("column " + std::to_string(c) + " of " + std::to_string(column_limit));
  for (const std::int32_t t : tied)
    if (t < 0 || static_cast<std::size_t>(t) >= motion.size())
      throw std::out_of_range("tied entity " + std::to_string(t) + " of " + std::to_string(motion.size()));

  mode_ = mode;
  slots_ = slots;
  tied_ = std::move(tied);
  row_ptr_ = std::move(row_ptr);
  columns_ = std::move(columns);
  values_ = std::move(values);
  reach_ = 0;
  const std::vector<std::int32_t>& points = mode == Mode::slave ? tied_ : columns_;
  for (const std::int32_t p : points) reach_ = std::max(reach_, static_cast<std::size_t>(p) + 1);
  transpose(mode == Mode::slave ? slots_ : reach_, row_ptr_, columns_, values_, turned_ptr_, turned_rows_,
            turned_values_);
  origin_.assign(motion.displacement.begin(), motion.displacement.begin() + static_cast<long>(reach_));
  projected_.assign(3 * slots_, 0.0);
  answer_.assign(3 * slots_, 0.0);
}

std::span<const double> Tie::project(const Motion& motion, const StepContext& context) {
  if (mode_ == Mode::gap) project_gap(motion, context.dt);
  if (mode_ == Mode::slave) project_slave(motion, context.dt);
  return projected_;
}

void Tie::project_gap(const Motion& motion, double dt) {
  const Vec rate = splat(1.0 / dt);
  for (std::size_t r = 0; r < slots_; ++r) {
    Vec gap{};
    for (std::int32_t k = row_ptr_[r]; k < row_ptr_[r + 1]; ++k) {
      const std::int32_t e = columns_[k];
      gap += splat(values_[k]) * (motion.velocity[e] + rate * (motion.displacement[e] - origin_[e]));
    }
    store(&projected_[3 * r], gap);
  }
}

void Tie::project_slave(const Motion& motion, double dt) {
  const bool viscous = !motion.viscosity.empty();
  for (std::size_t s = 0; s < slots_; ++s) {
    Vec total{};
    for (std::int32_t k = turned_ptr_[s]; k < turned_ptr_[s + 1]; ++k) {
      const std::int32_t e = tied_[turned_rows_[k]];
      Vec inertia = splat(motion.mass[e]);
      if (viscous) inertia += splat(0.5 * dt) * motion.viscosity[e];
      total += splat(turned_values_[k]) * inertia * motion.velocity[e];
    }
    store(&projected_[3 * s], total);
  }
}

void Tie::correct(Motion& motion, const StepContext& context) {
  const Vec rate = splat(1.0 / context.dt);
  double first = 0, second = 0;
  const auto finish = [&](std::size_t e, Vec impulse) {
    motion.tie_force[e] = rate * impulse;
    if (!motion.measured) return;
    first += dot(impulse, motion.old_velocity[e]);
    second += dot(impulse, motion.velocity[e]);
  };
  if (mode_ == Mode::gap) {
    for (std::size_t e = 0; e < reach_; ++e) {
      Vec impulse{};
      for (std::int32_t k = turned_ptr_[e]; k < turned_ptr_[e + 1]; ++k)
        impulse -= splat(turned_values_[k]) * load(&answer_[3 * turned_rows_[k]]);
      motion.velocity[e] += motion.mobility[e] * impulse;
      finish(e, impulse);
    }
  } else if (mode_ == Mode::slave) {
    const bool viscous = !motion.viscosity.empty();
    for (std::size_t t = 0; t < tied_.size(); ++t) {
      const std::int32_t e = tied_[t];
      Vec corrected{};
      for (std::int32_t k = row_ptr_[t]; k < row_ptr_[t + 1]; ++k)
        corrected += splat(values_[k]) * load(&answer_[3 * columns_[k]]);
      Vec inertia = splat(motion.mass[e]);
      if (viscous) inertia += splat(0.5 * context.dt) * motion.viscosity[e];
      const Vec impulse = inertia * (corrected - motion.velocity[e]);
      motion.velocity[e] = corrected;
      finish(static_cast<std::size_t>(e), impulse);
    }
  }
  if (motion.measured) work.add(0.5 * first, 0.5 * second);
}

double Tie::largest_displacement(const Motion& motion) const {
  double largest = 0.0;
  for (std::size_t e = 0; e < reach_; ++e) largest = std::max(largest, norm(motion.displacement[e] - origin_[e]));
  return largest;
}

}  // namespace gabion::engine
