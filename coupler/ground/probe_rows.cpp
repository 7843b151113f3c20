#include "coupler/ground/probe_rows.hpp"

#include <Eigen/Dense>
#include <cmath>
#include <numeric>
#include <stdexcept>

namespace gabion::coupler {

namespace {

constexpr double fit_diameters = 2.0;
constexpr std::size_t enough_grains = 12;
constexpr double widen = 1.25;

}  // namespace

ProbeRow probe_in_grains(const Point& at, const GrainSet& grains, const Box& ground,
                         const std::array<bool, 3>& periodic) {
  if (grains.position.size() < 4) throw std::runtime_error("probe: fewer than four grains to fit");
  const double mean_radius =
      std::accumulate(grains.radius.begin(), grains.radius.end(), 0.0) / static_cast<double>(grains.radius.size());
  const auto offset = [&](std::size_t g) {
    Eigen::Vector3d d;
    for (int axis = 0; axis < 3; ++axis) {
      d[axis] = grains.position[g][axis] - at[axis];
      const double period = ground.hi[axis] - ground.lo[axis];
      if (periodic[axis]) d[axis] -= period * std::round(d[axis] / period);
    }
    return d;
  };
  ProbeRow row;
  double radius = fit_diameters * 2.0 * mean_radius;
  const std::size_t wanted = std::min(enough_grains, grains.position.size());
  for (; row.entities.size() < wanted; radius *= widen) {
    row.entities.clear();
    for (std::size_t g = 0; g < grains.position.size(); ++g)
      if (offset(g).norm() <= radius) row.entities.push_back(static_cast<std::int32_t>(g));
  }
  Eigen::Matrix4d normal = Eigen::Matrix4d::Zero();
  for (const std::int32_t g : row.entities) {
    Eigen::Vector4d p;
    p << 1.0, offset(static_cast<std::size_t>(g));
    normal += p * p.transpose();
  }
  const Eigen::Vector4d at_point = normal.fullPivLu().solve(Eigen::Vector4d::UnitX());
  for (const std::int32_t g : row.entities) {
    Eigen::Vector4d p;
    p << 1.0, offset(static_cast<std::size_t>(g));
    row.coefficients.push_back(p.dot(at_point));
  }
  return row;
}

ProbeRow probe_in_mesh(const Point& at, const HexMesh& mesh, const Zone& zone) {
  const Stencil stencil = mesh.stencil(zone, at);
  ProbeRow row;
  for (int c = 0; c < 8; ++c) {
    if (stencil.value[c] == 0.0) continue;
    row.entities.push_back(static_cast<std::int32_t>(stencil.node[c]));
    row.coefficients.push_back(stencil.value[c]);
  }
  return row;
}

}  // namespace gabion::coupler
