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
  rates_ = one_rate(node_count_);
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
  bricks_.arrange(reach, rates_.tier_of_element);
  distorted_.arrange(reach, rates_.tier_of_element);
  shares_.assign(static_cast<std::size_t>(threads), {});
  const std::vector<std::size_t> corners = corners_before();
  const NodeRange all{0, static_cast<std::int32_t>(node_count_)};
  const std::vector<std::vector<Task>> none(1 + rates_.tiers());
  for (const NodeRange nodes : threads > 1 ? rates_.nodes : std::vector<NodeRange>{all}) {
    const std::vector<NodeRange> parts = cut(corners, nodes, threads);
    for (std::size_t t = 0; t < parts.size(); ++t) shares_[t].push_back({parts[t], none, none});
  }
  divide(bricks_, &Share::bricks);
  divide(distorted_, &Share::distorted);
}

/// Number of element corners on the nodes before each node.
std::vector<std::size_t> ElementForces::corners_before() const {
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
  return corners;
}

/// Cuts the nodes where the numbers of element corners before and after are in proportion.
std::vector<NodeRange> ElementForces::cut(const std::vector<std::size_t>& corners, NodeRange nodes, int parts) {
  std::vector<NodeRange> ranges;
  std::int32_t first = nodes.first;
  const std::size_t start = corners[nodes.first], total = corners[nodes.last] - start;
  for (int t = 1; t <= parts; ++t) {
    const std::size_t until = start + total * static_cast<std::size_t>(t) / static_cast<std::size_t>(parts);
    auto last = static_cast<std::int32_t>(std::lower_bound(corners.begin(), corners.end(), until) - corners.begin());
    last = t == parts ? nodes.last : std::clamp(last, first, nodes.last);
    ranges.push_back({first, last});
    first = last;
  }
  return ranges;
}

template <class Batch>
void ElementForces::divide(const Batches<Batch>& batches, std::vector<std::vector<Task>> Share::*tasks) {
  for (std::size_t b = 0; b < batches.batch.size(); ++b) {
    const std::size_t group = b < batches.interface_end ? interface_group : interior_group(batches.tier[b]);
    for (std::vector<Share>& thread : shares_)
      for (Share& share : thread) {
        int owned = 0;
        for (int corner = 0; corner < 8; ++corner)
          for (int lane = 0; lane < lane_count; ++lane) owned += share.own.holds(batches.batch[b].node[corner][lane]);
        if (owned > 0) (share.*tasks)[group].push_back({static_cast<std::uint32_t>(b), owned == batch_nodes});
      }
  }
}

void ElementForces::start(const VecField& body, VecField& force, std::size_t tiers) const {
  const auto threads = static_cast<int>(shares_.size());
  const std::int32_t end = tiers == 0 ? 0 : rates_.nodes[tiers - 1].last;
#pragma omp parallel for schedule(static, 1) num_threads(threads) if (threads > 1)
  for (int t = 0; t < threads; ++t) {
    flush_denormals();
    for (const Share& share : shares_[t]) {
      const NodeRange own{std::min(share.own.first, end), std::min(share.own.last, end)};
      if (body.empty())
        std::fill(force.begin() + own.first, force.begin() + own.last, Vec{});
      else
        std::copy(body.begin() + own.first, body.begin() + own.last, force.begin() + own.first);
    }
  }
}

void ElementForces::subtract(Part part, const VecField& displacement, VecField& force) const {
  const auto threads = static_cast<int>(shares_.size());
#pragma omp parallel for schedule(static, 1) num_threads(threads) if (threads > 1)
  for (int t = 0; t < threads; ++t)
    for (const Share& share : shares_[t]) {
      if (part == Part::interface) subtract_group(share, interface_group, displacement, force);
      if (part == Part::interior)
        for (std::size_t tier = 0; tier < rates_.tiers(); ++tier) subtract_group(share, interior_group(tier), displacement, force);
    }
}

void ElementForces::subtract(Part part, const VecField& displacement, VecField& force, std::size_t tiers) const {
  if (tiers == 0) return;
  if (part == Part::interface) return subtract(part, displacement, force);
  const auto threads = static_cast<int>(shares_.size());
#pragma omp parallel for schedule(static, 1) num_threads(threads) if (threads > 1)
  for (int t = 0; t < threads; ++t)
    for (const Share& share : shares_[t])
      for (std::size_t tier = tiers; tier-- > 0;) {
        subtract_group(share, interior_group(tier), displacement, force);
        if (tier > 0) raise(share, tier, force);
      }
}

void ElementForces::subtract_squared(const VecField& displacement, VecField& force) const {
  for (std::size_t tier = rates_.tiers(); tier-- > 0;) {
    for (const std::vector<Share>& thread : shares_)
      for (const Share& share : thread) {
        subtract_group(share, interior_group(tier), displacement, force);
        if (tier == 0) subtract_group(share, interface_group, displacement, force);
      }
    const double ratio = tier > 0 ? rates_.raise(tier) : static_cast<double>(rates_.rate[0]);
    for (Vec& f : force) f *= engine::splat(ratio * ratio);
  }
}

void ElementForces::subtract_group(const Share& share, std::size_t group, const VecField& displacement, VecField& force) const {
  for (const Task task : share.bricks[group])
    subtract_batch(bricks_.batch[task.batch], displacement.data(), share.own, task.whole, force.data());
  for (const Task task : share.distorted[group])
    subtract_batch(distorted_.batch[task.batch], displacement.data(), share.own, task.whole, force.data());
}

void ElementForces::raise(const Share& share, std::size_t tier, VecField& force) const {
  const Vec ratio = engine::splat(rates_.raise(tier));
  for (const NodeRange range : rates_.raised[tier]) {
    const std::int32_t last = std::min(range.last, share.own.last);
    for (std::int32_t n = std::max(range.first, share.own.first); n < last; ++n) force[n] *= ratio;
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

double ElementForces::excess_energy(const VecField& displacement) const {
  double total = 0.0;
  const auto weigh = [&](std::uint8_t tier, auto&& energy_of) {
    const auto rate = static_cast<double>(rates_.rate[tier]);
    if (tier > 0 || rate > 1.0) total += (rate * rate - 1.0) * energy_of();
  };
  for (std::size_t b = 0; b < bricks_.batch.size(); ++b)
    weigh(bricks_.tier[b], [&] { return brick_energy(bricks_.batch[b], materials_[bricks_.batch[b].material], displacement.data()); });
  for (std::size_t b = 0; b < distorted_.batch.size(); ++b)
    weigh(distorted_.tier[b], [&] { return distorted_energy(distorted_.batch[b], displacement.data()); });
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
