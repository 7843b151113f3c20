#include "continuum_server/element_forces.hpp"

#include <algorithm>
#include <numeric>

#include "continuum_server/denormals.hpp"

namespace gabion::continuum {

namespace {

/// Corners in lane order: a batch's nodes renumbered 0 to 63.
constexpr int batch_nodes = 8 * lane_count;
constexpr NodeRange all_batch_nodes{0, batch_nodes};

template <class Batch>
Batch renumbered(const Batch& batch) {
  Batch local = batch;
  for (int corner = 0; corner < 8; ++corner)
    for (int lane = 0; lane < lane_count; ++lane) local.node[corner][lane] = lane_count * corner + lane;
  return local;
}

}  // namespace

void ElementForces::build(const Mesh& mesh, const std::vector<SolidMaterial>& materials,
                          const std::vector<double>& share, Vec period) {
  *this = ElementForces{};
  node_count_ = mesh.nodes.size();
  for (const SolidMaterial& m : materials) materials_.push_back(brick_stiffness(m));
  for (std::size_t e = 0; e < mesh.elements.size(); ++e) {
    const Corners corners = corners_of(mesh, e, period);
    const auto number_nodes = [&](auto& batch) {
      for (int bits = 0; bits < 8; ++bits)
        for (int lane = 0; lane < lane_count; ++lane) batch.node[bits][lane] = mesh.elements[e][corner_at[bits]];
    };
    Vec size;
    if (is_brick(corners, size)) {
      BrickBatch single{};
      number_nodes(single);
      for (int axis = 0; axis < 3; ++axis) single.inverse[axis][0] = 2.0 / size[axis];
      single.scale[0] = share[e] * size[0] * size[1] * size[2] / 64.0;
      single.material = mesh.material[e];
      bricks_.add(static_cast<std::int32_t>(e), single);
    } else {
      DistortedBatch single{};
      number_nodes(single);
      const auto packed = packed_modal(condensed_stiffness(corners, materials[mesh.material[e]]));
      for (int entry = 0; entry < packed_size; ++entry) single.stiffness[entry][0] = share[e] * packed[entry];
      distorted_.add(static_cast<std::int32_t>(e), single);
    }
  }
  arrange(0, 1);
}

void ElementForces::arrange(std::size_t reach, int threads) {
  bricks_.arrange(reach);
  distorted_.arrange(reach);
  shares_.clear();
  for (const NodeRange own : node_ranges(threads)) shares_.push_back({own, {}, {}});
  divide(bricks_, &Share::bricks);
  divide(distorted_, &Share::distorted);
}

/// Cuts the nodes where the numbers of element corners before and after are in proportion.
std::vector<NodeRange> ElementForces::node_ranges(int threads) const {
  std::vector<std::size_t> corners(node_count_ + 1, 0);
  const auto count = [&](const auto& batches) {
    for (std::size_t slot = 0; slot < batches.element.size(); ++slot)
      if (batches.element[slot] != no_element)
        for (int corner = 0; corner < 8; ++corner)
          ++corners[batches.batch[slot / lane_count].node[corner][slot % lane_count] + 1];
  };
  count(bricks_);
  count(distorted_);
  std::partial_sum(corners.begin(), corners.end(), corners.begin());
  std::vector<NodeRange> ranges;
  std::int32_t first = 0;
  for (int t = 1; t <= threads; ++t) {
    const std::size_t until = corners.back() * static_cast<std::size_t>(t) / static_cast<std::size_t>(threads);
    auto last = static_cast<std::int32_t>(std::lower_bound(corners.begin(), corners.end(), until) - corners.begin());
    if (t == threads) last = static_cast<std::int32_t>(node_count_);
    ranges.push_back({first, last});
    first = last;
  }
  return ranges;
}

template <class Batch>
void ElementForces::divide(const Batches<Batch>& batches, std::vector<Task> (Share::*tasks)[2]) {
  for (std::size_t b = 0; b < batches.batch.size(); ++b) {
    const int part = static_cast<int>(b < batches.interface_end ? Part::interface : Part::interior);
    for (Share& share : shares_) {
      int owned = 0;
      for (int corner = 0; corner < 8; ++corner)
        for (int lane = 0; lane < lane_count; ++lane) owned += share.own.holds(batches.batch[b].node[corner][lane]);
      if (owned > 0) (share.*tasks)[part].push_back({static_cast<std::uint32_t>(b), owned == batch_nodes});
    }
  }
}

void ElementForces::start(const VecField& body, VecField& force) const {
  const auto threads = static_cast<int>(shares_.size());
#pragma omp parallel for schedule(static, 1) num_threads(threads) if (threads > 1)
  for (int t = 0; t < threads; ++t) {
    flush_denormals();
    const NodeRange own = shares_[t].own;
    if (body.empty())
      std::fill(force.begin() + own.first, force.begin() + own.last, Vec{});
    else
      std::copy(body.begin() + own.first, body.begin() + own.last, force.begin() + own.first);
  }
}

void ElementForces::subtract(Part part, const VecField& displacement, VecField& force) const {
  const auto threads = static_cast<int>(shares_.size());
#pragma omp parallel for schedule(static, 1) num_threads(threads) if (threads > 1)
  for (int t = 0; t < threads; ++t) {
    const Share& share = shares_[t];
    for (const Task task : share.bricks[static_cast<int>(part)])
      subtract_batch(bricks_.batch[task.batch], displacement.data(), share.own, task.whole, force.data());
    for (const Task task : share.distorted[static_cast<int>(part)])
      subtract_batch(distorted_.batch[task.batch], displacement.data(), share.own, task.whole, force.data());
  }
}

void ElementForces::subtract_batch(const BrickBatch& batch, const Vec* u, NodeRange own, bool whole, Vec* force) const {
  subtract_brick_forces(batch, materials_[batch.material], u, own, whole, force);
}

void ElementForces::subtract_batch(const DistortedBatch& batch, const Vec* u, NodeRange own, bool whole,
                                   Vec* force) const {
  subtract_distorted_forces(batch, u, own, whole, force);
}

double ElementForces::energy(const VecField& displacement) const {
  double total = 0.0;
  for (const BrickBatch& batch : bricks_.batch)
    total += brick_energy(batch, materials_[batch.material], displacement.data());
  for (const DistortedBatch& batch : distorted_.batch) total += distorted_energy(batch, displacement.data());
  return total;
}

template <class Batch>
double ElementForces::corner_force_sum(const Batches<Batch>& batches, const VecField& displacement) const {
  double total = 0.0;
  for (std::size_t b = 0; b < batches.batch.size(); ++b) {
    const Batch& batch = batches.batch[b];
    const Batch local = renumbered(batch);
    Vec u[batch_nodes], force[batch_nodes] = {};
    for (int n = 0; n < batch_nodes; ++n) u[n] = displacement[batch.node[n / lane_count][n % lane_count]];
    subtract_batch(local, u, all_batch_nodes, true, force);
    for (const Vec f : force) total += engine::norm(f);
  }
  return total;
}

double ElementForces::mean_corner_force(const VecField& displacement) const {
  const std::size_t corners = 8 * (bricks() + distorted());
  const double total = corner_force_sum(bricks_, displacement) + corner_force_sum(distorted_, displacement);
  return corners == 0 ? 0.0 : total / static_cast<double>(corners);
}

template <class Batch>
bool ElementForces::find_stiffness(const Batches<Batch>& batches, std::size_t element, ElementStiffness& result) const {
  const auto found = std::find(batches.element.begin(), batches.element.end(), static_cast<std::int32_t>(element));
  if (found == batches.element.end()) return false;
  const auto slot = static_cast<std::size_t>(found - batches.element.begin());
  const int lane = static_cast<int>(slot % lane_count);
  const Batch local = renumbered(batches.batch[slot / lane_count]);
  for (int column = 0; column < 24; ++column) {
    Vec u[batch_nodes] = {}, force[batch_nodes] = {};
    u[lane_count * corner_at[column / 3] + lane][column % 3] = 1.0;
    subtract_batch(local, u, all_batch_nodes, true, force);
    for (int row = 0; row < 24; ++row)
      result[24 * row + column] = -force[lane_count * corner_at[row / 3] + lane][row % 3];
  }
  return true;
}

ElementStiffness ElementForces::stiffness(std::size_t element) const {
  ElementStiffness result{};
  if (!find_stiffness(bricks_, element, result)) find_stiffness(distorted_, element, result);
  return result;
}

}  // namespace gabion::continuum
