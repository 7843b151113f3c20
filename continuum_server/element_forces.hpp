#pragma once
// Internal forces of the mesh. Deterministic for any number of threads: each thread owns a range of nodes,
// computes every element that touches it (the few between two ranges are computed twice) in one fixed order,
// and adds to its own nodes only. So each node's sum has the same terms in the same order.

#include <vector>

#include "continuum_server/batches.hpp"

namespace gabion::continuum {

/// Elements that touch a node of the interface, and all others.
enum class Part { interface, interior };

class ElementForces {
 public:
  /// share: factor of stiffness per element (one minus the bridging weight). Each element must have passed
  /// smallest_corner_jacobian() > 0.
  void build(const Mesh& mesh, const std::vector<SolidMaterial>& materials, const std::vector<double>& share,
             Vec period);

  /// Nodes below reach are the interface; call after build and when reach or the threads change.
  void arrange(std::size_t reach, int threads);

  /// force := body, or zero where body is empty. Also flushes denormals on each thread.
  void start(const VecField& body, VecField& force) const;
  /// force -= K u, the elements of one part.
  void subtract(Part part, const VecField& displacement, VecField& force) const;

  double energy(const VecField& displacement) const;
  /// Mean of |nodal force| over the corners of all elements, N.
  double mean_corner_force(const VecField& displacement) const;
  /// As the step sees it, with the share; N/m.
  ElementStiffness stiffness(std::size_t element) const;

  std::size_t bricks() const { return bricks_.elements(); }
  std::size_t distorted() const { return distorted_.elements(); }

 private:
  /// What one thread does: its nodes, and the batches that touch them; whole: owns every node of the batch.
  struct Task {
    std::uint32_t batch;
    bool whole;
  };
  struct Share {
    NodeRange own;
    std::vector<Task> bricks[2], distorted[2];  ///< by Part
  };
  template <class Batch>
  void divide(const Batches<Batch>& batches, std::vector<Task> (Share::*tasks)[2]);
  std::vector<NodeRange> node_ranges(int threads) const;

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
  std::vector<Share> shares_;  ///< one a thread
};

}  // namespace gabion::continuum
