#include "coupler/interface/multipliers.hpp"

#include <algorithm>
#include <cmath>

namespace gabion::coupler {

namespace {

using Entries = std::vector<Eigen::Triplet<double>>;

/// G m^-1 G^T for one component.
Factor::Matrix product(const SparseRows& rows, std::size_t points, const Inertia& inertia, int component) {
  Entries entries;
  for (std::size_t r = 0; r < rows.rows(); ++r)
    for (std::int32_t k = rows.row_ptr[r]; k < rows.row_ptr[r + 1]; ++k)
      entries.emplace_back(static_cast<int>(r), rows.columns[k], rows.values[k]);
  Factor::Matrix g(static_cast<long>(rows.rows()), static_cast<long>(points));
  g.setFromTriplets(entries.begin(), entries.end());
  Eigen::VectorXd mobility(static_cast<long>(points));
  for (std::size_t p = 0; p < points; ++p)
    mobility[static_cast<long>(p)] = inertia.freedom[p][component] / inertia.mass[p][component];
  return Factor::Matrix(g * mobility.asDiagonal() * g.transpose());
}

bool components_agree(const Inertia& inertia, const std::vector<bool>& used) {
  for (std::size_t p = 0; p < used.size(); ++p)
    if (used[p])
      for (int c = 1; c < 3; ++c)
        if (inertia.mass[p][c] != inertia.mass[p][0] || inertia.freedom[p][c] != inertia.freedom[p][0]) return false;
  return true;
}

std::vector<bool> used_points(std::size_t points, const std::vector<std::int32_t>& indices) {
  std::vector<bool> used(points, false);
  for (const std::int32_t i : indices) used[i] = true;
  return used;
}

}  // namespace

Multipliers::Multipliers(const InterfaceRows& rows, const Inertia& grains, const Inertia& nodes, bool row_sum)
    : rows_(rows), row_sum_(row_sum), right_(rows.slots), other_(rows.slots), solved_(rows.slots) {
  const bool gap = rows.kind == InterfaceRows::Kind::gap;
  const auto& grain_indices = gap ? rows.grains.columns : rows.tied_grains;
  const auto& node_indices = gap ? rows.nodes.columns : rows.tied_nodes;
  const bool alike = components_agree(grains, used_points(grains.mass.size(), grain_indices)) &&
                     components_agree(nodes, used_points(nodes.mass.size(), node_indices));
  for (int component = 0; component < (alike ? 1 : 3); ++component) {
    const Factor::Matrix matrix = gap ? gap_matrix(grains, nodes, component) : slave_matrix(grains, nodes, component);
    if (row_sum) {
      const Eigen::VectorXd sums = matrix * Eigen::VectorXd::Ones(matrix.cols());
      sums_.emplace_back(sums.data(), sums.data() + sums.size());
    } else {
      factors_.emplace_back(matrix);
    }
  }
  if (alike) prescribed_[1] = prescribed_[2] = prescribed_[0];
  report_.grains = rows.grain_count;
  report_.rows = rows.slots;
  report_.merged_rows = rows.merged_rows;
  report_.grains_per_row = rows.slots ? static_cast<double>(rows.grain_count) / static_cast<double>(rows.slots) : 0.0;
  report_.rank = rows.slots;
  for (const Factor& f : factors_) {
    report_.rank = std::min(report_.rank, f.rank());
    report_.condition = std::max(report_.condition, f.condition());
    report_.nonzeros = std::max(report_.nonzeros, f.nonzeros());
  }
}

Factor::Matrix Multipliers::gap_matrix(const Inertia& grains, const Inertia& nodes, int component) const {
  return product(rows_.grains, grains.mass.size(), grains, component) +
         product(rows_.nodes, nodes.mass.size(), nodes, component);
}

Factor::Matrix Multipliers::slave_matrix(const Inertia& grains, const Inertia& nodes, int component) {
  const SparseRows& n = rows_.grains;
  std::vector<double> fixed(rows_.slots, -1.0);  // inverse mass of prescribed slots
  for (std::size_t s = 0; s < rows_.slots; ++s) {
    const std::int32_t node = rows_.tied_nodes[s];
    if (nodes.freedom[node][component] == 0.0) fixed[s] = 1.0 / nodes.mass[node][component];
  }
  Entries entries;
  std::vector<std::vector<std::pair<std::int32_t, double>>> columns(rows_.slots);
  for (std::size_t s = 0; s < rows_.slots; ++s)
    entries.emplace_back(s, s, fixed[s] >= 0.0 ? 1.0 : nodes.mass[rows_.tied_nodes[s]][component]);
  for (std::size_t t = 0; t < rows_.tied_grains.size(); ++t) {
    const double m = grains.mass[rows_.tied_grains[t]][component];
    for (std::int32_t a = n.row_ptr[t]; a < n.row_ptr[t + 1]; ++a)
      for (std::int32_t b = n.row_ptr[t]; b < n.row_ptr[t + 1]; ++b) {
        const std::int32_t row = n.columns[a], column = n.columns[b];
        const double value = n.values[a] * m * n.values[b];
        if (fixed[row] >= 0.0) continue;
        if (fixed[column] >= 0.0)
          columns[column].emplace_back(row, value);
        else
          entries.emplace_back(row, column, value);
      }
  }
  for (std::size_t s = 0; s < rows_.slots; ++s)
    if (fixed[s] >= 0.0) prescribed_[component].push_back({static_cast<std::int32_t>(s), fixed[s], columns[s]});
  Factor::Matrix matrix(static_cast<long>(rows_.slots), static_cast<long>(rows_.slots));
  matrix.setFromTriplets(entries.begin(), entries.end());
  return matrix;
}

void Multipliers::solve(std::span<const double> from_grains, std::span<const double> from_nodes, std::span<double> answer) {
  for (std::size_t s = 0; s < rows_.slots; ++s)
    for (int c = 0; c < 3; ++c) right_[s][c] = from_grains[3 * s + c] + from_nodes[3 * s + c];
  if (row_sum_) {
    for (std::size_t s = 0; s < rows_.slots; ++s)
      for (int c = 0; c < 3; ++c) right_[s][c] /= sums_[sums_.size() == 1 ? 0 : c][s];
  } else {
    if (rows_.kind == InterfaceRows::Kind::slave) solve_slave(from_nodes);
    if (factors_.size() == 1) {
      factors_[0].solve(right_);
    } else {
      for (int c = 0; c < 3; ++c) {  // one factor a component: each solves all three and keeps its own
        other_ = right_;
        factors_[c].solve(other_);
        for (std::size_t s = 0; s < rows_.slots; ++s) solved_[s][c] = other_[s][c];
      }
      right_.swap(solved_);
    }
  }
  for (std::size_t s = 0; s < rows_.slots; ++s)
    for (int c = 0; c < 3; ++c) answer[3 * s + c] = right_[s][c];
}

/// Moves what is known of prescribed slots to the right-hand side.
void Multipliers::solve_slave(std::span<const double> from_nodes) {
  for (int c = 0; c < 3; ++c)
    for (const Prescribed& p : prescribed_[c]) {
      const double known = from_nodes[3 * static_cast<std::size_t>(p.slot) + c] * p.inverse_mass;
      right_[p.slot][c] = known;
      for (const auto& [row, value] : p.column) right_[row][c] -= value * known;
    }
}

InterfaceRows explicit_rows(const InterfaceRows& slave) {
  InterfaceRows rows;
  rows.kind = InterfaceRows::Kind::gap;
  rows.grain_count = slave.grain_count;
  rows.slots = slave.tied_grains.size();
  rows.slot_position.resize(rows.slots);
  for (std::size_t t = 0; t < rows.slots; ++t) {
    rows.grains.push(slave.tied_grains[t], -1.0);
    rows.grains.end_row();
    for (std::int32_t k = slave.grains.row_ptr[t]; k < slave.grains.row_ptr[t + 1]; ++k)
      rows.nodes.push(slave.tied_nodes[slave.grains.columns[k]], slave.grains.values[k]);
    rows.nodes.end_row();
  }
  return rows;
}

}  // namespace gabion::coupler
