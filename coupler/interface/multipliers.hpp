#pragma once
// From the two engines' projected trial motions to the multipliers.
//
//   gap      A mu = g_d + g_c,                 A = G_d m^^-1 G_d^T + G_c M^^-1 G_c^T
//   slave    (M^ + N^T m^ N) V = b_c + b_d     the equivalent nodal system of the strict rows
//   row_sum  mu_i = g_i / sum_k A_ik           the explicit form of Xiao & Belytschko 2004; loses energy
//
// Hatted masses are weighted and include half a step of dashpots; prescribed components have no mobility.

#include <memory>
#include <span>
#include <string>
#include <vector>

#include "coupler/interface/factor.hpp"
#include "coupler/interface/rows.hpp"

namespace gabion::coupler {

/// Per point and component: m + c dt/2 [kg], and 1 where free, 0 where prescribed.
struct Inertia {
  std::vector<Triple> mass;
  std::vector<Triple> freedom;
};

struct InterfaceReport {
  std::size_t grains = 0, rows = 0, rank = 0, merged_rows = 0, nonzeros = 0;
  double condition = 0.0;
  double grains_per_row = 0.0;
};

class Multipliers {
 public:
  /// row_sum needs rows made by explicit_rows.
  Multipliers(const InterfaceRows& rows, const Inertia& grains, const Inertia& nodes, bool row_sum);

  /// answer := mu (gap) or V (slave), [slots][3]; no allocation.
  void solve(std::span<const double> from_grains, std::span<const double> from_nodes, std::span<double> answer);

  const InterfaceReport& report() const { return report_; }

 private:
  Factor::Matrix gap_matrix(const Inertia& grains, const Inertia& nodes, int component) const;
  Factor::Matrix slave_matrix(const Inertia& grains, const Inertia& nodes, int component);
  void solve_slave(std::span<const double> from_nodes);

  const InterfaceRows& rows_;
  bool row_sum_ = false;
  std::vector<Factor> factors_;             ///< one, or one a component where masses or constraints differ
  std::vector<std::vector<double>> sums_;   ///< row_sum: row sums a component
  struct Prescribed {
    std::int32_t slot;
    double inverse_mass;                    ///< of the node; its trial velocity stands
    std::vector<std::pair<std::int32_t, double>> column;  ///< free slots that feel it
  };
  std::array<std::vector<Prescribed>, 3> prescribed_;
  std::vector<Triple> right_, other_, solved_;
  InterfaceReport report_;
};

/// Strict rows written out one per grain (G_d = -1, G_c = N), as row_sum needs them.
InterfaceRows explicit_rows(const InterfaceRows& slave);

}  // namespace gabion::coupler
