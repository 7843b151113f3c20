// What ContinuumEngine::prepare() computes from the mesh: shapes, weights, masses, body loads.

#include <algorithm>
#include <sstream>
#include <string>

#include "continuum_server/continuum_engine.hpp"

namespace gabion::continuum {

using engine::RequestError;

void ContinuumEngine::check_shapes() const {
  for (std::size_t e = 0; e < mesh_.elements.size(); ++e) {
    const Corners corners = corners_of(mesh_, e, edges());
    double smallest = smallest_corner_jacobian(corners);
    if (smallest > 0.0)
      for (const GaussPoint& point : gauss_points(corners)) smallest = std::min(smallest, point.volume);
    if (!(smallest > 0.0)) {
      std::ostringstream value;
      value << smallest;
      throw RequestError(
          "MESH.elements",
          "element " + std::to_string(e) + " is inverted or flat (smallest Jacobian " + value.str() + " m3)",
          "check the order of its corners, its nodes' positions and its wrap bits");
    }
  }
}

/// 1 - w at the centre, from the weight without its floor, but not below the floor itself.
void ContinuumEngine::weigh_elements() {
  engine::WeightField grains = weights;
  grains.floor = 0.0;
  share_.assign(mesh_.elements.size(), 1.0);
  if (weights.width <= 0.0) return;
  for (std::size_t e = 0; e < share_.size(); ++e)
    share_[e] = std::max(weights.floor, 1.0 - grains.at(centre_of(corners_of(mesh_, e, edges()))));
}

void ContinuumEngine::sum_masses() {
  std::fill(motion.mass.begin(), motion.mass.end(), 0.0);
  std::fill(motion.plain_mass.begin(), motion.plain_mass.end(), 0.0);
  for (std::size_t e = 0; e < mesh_.elements.size(); ++e) {
    const double density = materials_[mesh_.material[e]].density;
    const auto points = gauss_points(corners_of(mesh_, e, edges()));
    for (int corner = 0; corner < 8; ++corner) {
      double mass = 0.0;
      for (const GaussPoint& point : points) mass += density * point.shape[corner] * point.volume;
      motion.plain_mass[mesh_.elements[e][corner]] += mass;
      motion.mass[mesh_.elements[e][corner]] += share_[e] * mass;
    }
  }
  for (std::size_t n = 0; n < motion.size(); ++n)
    if (!(motion.mass[n] > 0.0))
      throw RequestError("WEIGHTS.floor", "node " + std::to_string(n) + " has no mass left",
                         "give a floor above 0, or leave elements with weight 1 - w = 0 out of the mesh");
}

void ContinuumEngine::add_body_loads() {
  body_.clear();
  if (engine::norm(options.gravity) == 0.0) return;
  engine::WeightField grains = weights;
  grains.floor = 0.0;
  const bool weighted = weights.width > 0.0;
  body_.assign(motion.size(), Vec{});
  for (std::size_t e = 0; e < mesh_.elements.size(); ++e) {
    const double density = materials_[mesh_.material[e]].density;
    for (const GaussPoint& point : gauss_points(corners_of(mesh_, e, edges()))) {
      const double share = weighted ? 1.0 - grains.at(point.position) : 1.0;
      for (int corner = 0; corner < 8; ++corner)
        body_[mesh_.elements[e][corner]] +=
            engine::splat(share * density * point.volume * point.shape[corner]) * options.gravity;
    }
  }
}

}  // namespace gabion::continuum
