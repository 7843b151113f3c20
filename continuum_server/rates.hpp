#pragma once
// Elements of several rates. An element of rate r is evaluated at the steps whose number is a multiple of r, and then
// gives the impulse r dt F; a node takes the smallest rate of its elements. Between its own steps nothing acts on a node,
// so it takes them whole:
//
//   v(n+r/2) = v(n-r/2) + r dt M^-1 sum over its elements (r_e/r) F_e(u_n),   u(n+r) = u(n) + r dt v(n+r/2)
//
// Source: impulses at the coarse steps, r-RESPA (Tuckerman, Berne & Martyna 1992; Grubmueller et al. 1991); as variational
// integrators with a step for each element, Lew, Marsden, Ortiz & West (2003). Symplectic; the energy swings and does not
// drift. Rates are powers of two, so that a finer tier takes part in every step of a coarser one.
//
// A node with coarser elements gets their forces times r_e/r. Nodes are numbered by their smallest and then by their
// largest rate, so that such nodes stand at the end of their tier; forces are summed from the coarsest elements to the
// finest, and these nodes' sums raised by the ratio of the rates before the next finer tier is added.

#include <cstdint>
#include <span>
#include <vector>

#include "continuum_server/lanes.hpp"
#include "continuum_server/mesh.hpp"

namespace gabion::continuum {

struct Rates {
  std::vector<std::uint64_t> rate{1};         ///< of each tier, ascending
  std::vector<NodeRange> nodes;               ///< of each tier
  std::vector<std::uint8_t> tier_of_element;  ///< empty: all of tier 0
  /// Nodes of finer tiers with elements of tier t or coarser, one range a finer tier; their sums are raised when tier t is
  /// through.
  std::vector<std::vector<NodeRange>> raised{{}};

  std::size_t tiers() const { return rate.size(); }
  bool several() const { return rate.back() > 1; }
  /// Tiers that take part in a step: those before this number.
  std::size_t active(std::uint64_t step) const {
    std::size_t count = 0;
    while (count < rate.size() && step % rate[count] == 0) ++count;
    return count;
  }
  /// Ratio by which sums are raised after tier t.
  double raise(std::size_t t) const { return static_cast<double>(rate[t] / rate[t - 1]); }
};

/// One rate for all nodes.
Rates one_rate(std::size_t nodes);

/// From the rate of each element; empty: one rate. engine::RequestError naming RATES: a rate that is no power of two, more
/// tiers than engine::Work keeps, nodes that are not numbered by their rates.
Rates make_rates(const Mesh& mesh, std::span<const std::uint8_t> rate);

/// engine::RequestError where an element that touches one of the first reach nodes, or touches such an element, has
/// another rate than 1: energy then resonates between the two media.
void check_margin(const Rates& rates, const Mesh& mesh, std::size_t reach);

}  // namespace gabion::continuum
