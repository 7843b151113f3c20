#include "coupler/interface/rotation.hpp"

#include <Eigen/Dense>
#include <set>

namespace gabion::coupler {

double interface_rotation(const HexMesh& mesh, const InterfaceRows& rows, std::span<const double> displacement) {
  const auto& source = rows.kind == InterfaceRows::Kind::gap ? rows.nodes.columns : rows.tied_nodes;
  const std::set<std::int32_t> tied(source.begin(), source.end());
  const auto position = [&](std::int32_t n) { return Eigen::Vector3d(mesh.nodes[n][0], mesh.nodes[n][1], mesh.nodes[n][2]); };
  const auto moved = [&](std::int32_t n) {
    const double* u = &displacement[3 * static_cast<std::size_t>(n)];
    return Eigen::Vector3d(u[0], u[1], u[2]);
  };
  Eigen::Vector3d centre = Eigen::Vector3d::Zero(), mean = Eigen::Vector3d::Zero();
  for (const std::int32_t n : tied) {
    centre += position(n);
    mean += moved(n);
  }
  centre /= static_cast<double>(tied.size());
  mean /= static_cast<double>(tied.size());
  // u = theta x r: normal equations sum (r.r I - r r^T) theta = sum r x u
  Eigen::Matrix3d inertia = Eigen::Matrix3d::Zero();
  Eigen::Vector3d turning = Eigen::Vector3d::Zero();
  for (const std::int32_t n : tied) {
    const Eigen::Vector3d r = position(n) - centre;
    inertia += r.squaredNorm() * Eigen::Matrix3d::Identity() - r * r.transpose();
    turning += r.cross(moved(n) - mean);
  }
  return inertia.fullPivLu().solve(turning).norm();
}

}  // namespace gabion::coupler
