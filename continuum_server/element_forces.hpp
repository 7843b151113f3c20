#pragma once
// Internal forces of the mesh. Deterministic for any number of threads: each thread owns a range of nodes,
// computes every element that touches it (the few between two ranges are computed twice) in one fixed order,
// and adds to its own nodes only. So each node's sum has the same terms in the same order. With several rates each
// thread owns a range of every tier's nodes, so that the work of each step is shared out.

#include <vector>

#include "continuum_server/batches.hpp"
#include "continuum_server/rates.hpp"

namespace gabion::continuum {

/// Elements that touch a node of the interface, and all others.
enum class Part { interface, interior };

class ElementForces {
 public:
  /// share: factor of stiffness per element (one minus the bridging weight). Each element must have passed
  /// smallest_corner_jacobian() > 0.
  void build(const Mesh& mesh, const std::vector<SolidMaterial>& materials, const std::vector<double>& share,
             Vec period);

  /// Takes effect with arrange().
  void set_rates(Rates rates) { rates_ = std::move(rates); }
  /// Nodes below reach are the interface; call after build and when rates, reach or the threads change.
  void arrange(std::size_t reach, int threads);

  /// force := body, or zero where body is empty. Also flushes denormals on each thread.
  void start(const VecField& body, VecField& force) const { start(body, force, rates_.tiers()); }
  /// force -= K u, the elements of one part, whatever their rates.
  void subtract(Part part, const VecField& displacement, VecField& force) const;

  /// The same for the nodes and elements of the first tiers alone: force -= sum of r_e/r K_e u on a node of rate r.
  void start(const VecField& body, VecField& force, std::size_t tiers) const;
  void subtract(Part part, const VecField& displacement, VecField& force, std::size_t tiers) const;
  /// force -= sum of r_e^2 K_e u, the interior and the interface. As no element can vibrate faster on its own than
  /// its rate lets it, the highest frequency of this sum is that to which a step of the run must be kept.
  void subtract_squared(const VecField& displacement, VecField& force) const;
  const Rates& rates() const { return rates_; }

  double energy(const VecField& displacement) const;
  /// Sum of (r_e^2 - 1) times the energies of the elements.
  double excess_energy(const VecField& displacement) const;
  /// Mean of |nodal force| over the corners of all elements, N.
  double mean_corner_force(const VecField& displacement) const;
  /// As the step sees it, with the share; N/m.
  ElementStiffness stiffness(std::size_t element) const;

  std::size_t bricks() const { return bricks_.elements(); }
  std::size_t distorted() const { return distorted_.elements(); }

 private:
  /// A batch that touches a share's nodes; whole: all its nodes are the share's.
  struct Task {
    std::uint32_t batch;
    bool whole;
  };
  /// Nodes of one thread, and the batches that touch them, by group: the interface, then the interior of each tier.
  struct Share {
    NodeRange own;
    std::vector<std::vector<Task>> bricks, distorted;
  };
  static constexpr std::size_t interface_group = 0;
  static std::size_t interior_group(std::size_t tier) { return 1 + tier; }
  template <class Batch>
  void divide(const Batches<Batch>& batches, std::vector<std::vector<Task>> Share::*tasks);
  std::vector<std::size_t> corners_before() const;
  static std::vector<NodeRange> cut(const std::vector<std::size_t>& corners, NodeRange nodes, int parts);
  void subtract_group(const Share& share, std::size_t group, const VecField& displacement, VecField& force) const;
  void raise(const Share& share, std::size_t tier, VecField& force) const;

  void subtract_batch(const BrickBatch& batch, const Vec* u, NodeRange own, bool whole, Vec* force) const;
  void subtract_batch(const DistortedBatch& batch, const Vec* u, NodeRange own, bool whole, Vec* force) const;
  template <class Batch>
  double corner_force_sum(const Batches<Batch>& batches, const VecField& displacement) const;
  template <class Batch>
  bool find_stiffness(const Batches<Batch>& batches, std::size_t element, ElementStiffness& result) const;

  std::size_t node_count_ = 0;
  std::vector<BrickStiffness> materials_;
  Batches<BrickBatch> bricks_;
  Batches<DistortedBatch> distorted_;
  Rates rates_;
  std::vector<std::vector<Share>> shares_;  ///< of each thread: one, or with several threads and rates one a tier
};

}  // namespace gabion::continuum
