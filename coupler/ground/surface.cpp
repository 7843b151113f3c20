#include "coupler/ground/surface.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numeric>

namespace gabion::coupler {

namespace {

constexpr double rays_per_smallest_radius = 4.0;
constexpr double depth_in_diameters = 2.0;
constexpr double contact_margin = 0.2;  // in radii: how far from touching a grain still rests against a face

struct FaceFrame {
  int normal, across, along;  ///< axes
  bool high;
  double position;
};

FaceFrame frame_of(int face, const Box& ground) {
  const int normal = face / 2;
  const bool high = face % 2 == 1;
  return {normal, (normal + 1) % 3, (normal + 2) % 3, high, high ? ground.hi[normal] : ground.lo[normal]};
}

/// Scales the areas by 1 + a + b s + c t, so that total and first moments meet the targets.
void correct_moments(Patch& patch, const std::vector<std::array<double, 2>>& at, double area, std::array<double, 2> moment) {
  Eigen::Matrix3d m = Eigen::Matrix3d::Zero();
  Eigen::Vector3d have = Eigen::Vector3d::Zero();
  for (std::size_t k = 0; k < patch.area.size(); ++k) {
    const Eigen::Vector3d p(1.0, at[k][0], at[k][1]);
    m += patch.area[k] * p * p.transpose();
    have += patch.area[k] * p;
  }
  const Eigen::Vector3d wanted(area, moment[0], moment[1]);
  const Eigen::Vector3d factor = m.fullPivLu().solve(wanted - have);
  for (std::size_t k = 0; k < patch.area.size(); ++k)
    patch.area[k] *= 1.0 + factor[0] + factor[1] * at[k][0] + factor[2] * at[k][1];
}

}  // namespace

double Patch::total() const { return std::accumulate(area.begin(), area.end(), 0.0); }

Patch grain_patch(int face, const Box& ground, const std::array<bool, 3>& periodic, const Zone& zone,
                  const GrainSet& grains) {
  const FaceFrame f = frame_of(face, ground);
  double r_min = scene::infinity, r_max = 0.0;
  for (const double r : grains.radius) r_min = std::min(r_min, r), r_max = std::max(r_max, r);
  const double width = ground.hi[f.across] - ground.lo[f.across], height = ground.hi[f.along] - ground.lo[f.along];
  const int columns = std::max(1, static_cast<int>(std::ceil(width / (r_min / rays_per_smallest_radius))));
  const int lines = std::max(1, static_cast<int>(std::ceil(height / (r_min / rays_per_smallest_radius))));
  const double dx = width / columns, dy = height / lines;
  const double deepest = depth_in_diameters * 2.0 * r_max;

  // depth of the first grain each ray meets
  std::vector<double> depth(static_cast<std::size_t>(columns) * lines, deepest);
  std::vector<std::int32_t> hit(depth.size(), -1);
  const auto wrap = [](int i, int n, bool periodic_side) { return periodic_side ? (i % n + n) % n : (i < 0 || i >= n ? -1 : i); };
  for (std::size_t g = 0; g < grains.position.size(); ++g) {
    const double r = grains.radius[g];
    const double to_centre = f.high ? f.position - grains.position[g][f.normal] : grains.position[g][f.normal] - f.position;
    if (to_centre - r >= deepest) continue;
    const double cx = (grains.position[g][f.across] - ground.lo[f.across]) / dx;
    const double cy = (grains.position[g][f.along] - ground.lo[f.along]) / dy;
    const int reach_x = static_cast<int>(r / dx) + 1, reach_y = static_cast<int>(r / dy) + 1;
    for (int j = static_cast<int>(std::floor(cy)) - reach_y; j <= cy + reach_y; ++j)
      for (int i = static_cast<int>(std::floor(cx)) - reach_x; i <= cx + reach_x; ++i) {
        const double sx = (i + 0.5 - cx) * dx, sy = (j + 0.5 - cy) * dy;
        const double rise = r * r - sx * sx - sy * sy;
        if (rise <= 0.0) continue;
        const int column = wrap(i, columns, periodic[f.across]), line = wrap(j, lines, periodic[f.along]);
        if (column < 0 || line < 0) continue;
        const std::size_t ray = static_cast<std::size_t>(line) * columns + column;
        const double at = to_centre - std::sqrt(rise);
        if (at < depth[ray]) {
          depth[ray] = at;
          hit[ray] = static_cast<std::int32_t>(g);
        }
      }
  }

  std::map<std::int32_t, double> areas;
  double area = 0.0;
  std::array<double, 2> moment{};
  for (int line = 0; line < lines; ++line)
    for (int column = 0; column < columns; ++column) {
      Point x;
      x[f.normal] = f.position;
      x[f.across] = ground.lo[f.across] + (column + 0.5) * dx;
      x[f.along] = ground.lo[f.along] + (line + 0.5) * dy;
      const bool ours = zone.beyond_outer(x) <= 0.0;
      const double share = ours ? (zone.overlap() > 0.0 ? zone.weight(x) : 1.0) : 0.0;
      if (share <= 0.0) continue;
      area += share * dx * dy;
      moment[0] += share * dx * dy * x[f.across];
      moment[1] += share * dx * dy * x[f.along];
      const std::int32_t grain = hit[static_cast<std::size_t>(line) * columns + column];
      if (grain >= 0) areas[grain] += share * dx * dy;
    }
  Patch patch;
  std::vector<std::array<double, 2>> at;
  for (const auto& [grain, a] : areas) {
    patch.entities.push_back(grain);
    patch.area.push_back(a);
    at.push_back({grains.position[grain][f.across], grains.position[grain][f.along]});
  }
  if (periodic[f.across] || periodic[f.along]) {  // moments mean nothing there: only the total
    const double factor = patch.area.empty() ? 1.0 : area / patch.total();
    for (double& a : patch.area) a *= factor;
  } else if (!patch.area.empty()) {
    correct_moments(patch, at, area, moment);
  }
  return patch;
}

Patch mesh_patch(int face, const HexMesh& mesh, const Zone& zone) {
  const int normal = face / 2, across = (normal + 1) % 3, along = (normal + 2) % 3;
  const bool high = face % 2 == 1;
  const double gauss[2] = {0.5 - 0.5 / std::sqrt(3.0), 0.5 + 0.5 / std::sqrt(3.0)};
  const bool bridging = zone.has_interface() && zone.overlap() > 0.0;
  std::map<std::int32_t, double> areas;
  for (const Cell& cell : mesh.cells) {
    if (cell[normal] != (high ? mesh.grid.cells(normal) - 1 : 0)) continue;
    const auto side = [&](int axis, int end) { return mesh.grid.lines(axis)[static_cast<std::size_t>(cell[axis] + end)]; };
    const double dx = side(across, 1) - side(across, 0), dy = side(along, 1) - side(along, 0);
    for (const double s : gauss)
      for (const double t : gauss) {
        Point x;
        x[normal] = side(normal, high ? 1 : 0);
        x[across] = side(across, 0) + s * dx;
        x[along] = side(along, 0) + t * dy;
        const double share = bridging ? 1.0 - (zone.beyond_outer(x) <= 0.0 ? zone.weight(x) : 0.0) : 1.0;
        const Stencil stencil = mesh.grid.stencil(cell, x);
        for (int c = 0; c < 8; ++c)
          if (stencil.value[c] > 1e-12) areas[mesh.node_of_grid[stencil.node[c]]] += 0.25 * dx * dy * share * stencil.value[c];
      }
  }
  Patch patch;
  for (const auto& [node, a] : areas) {
    patch.entities.push_back(node);
    patch.area.push_back(a);
  }
  return patch;
}

std::vector<std::int32_t> grains_at_face(int face, const Box& ground, const GrainSet& grains) {
  const FaceFrame f = frame_of(face, ground);
  std::vector<std::int32_t> resting;
  for (std::size_t g = 0; g < grains.position.size(); ++g)
    if (std::fabs(grains.position[g][f.normal] - f.position) <= (1.0 + contact_margin) * grains.radius[g])
      resting.push_back(static_cast<std::int32_t>(g));
  return resting;
}

std::vector<std::int32_t> nodes_at_face(int face, const HexMesh& mesh) {
  const int normal = face / 2;
  const auto& lines = mesh.grid.lines(normal);
  const double position = face % 2 == 1 ? lines.back() : lines.front();
  std::vector<std::int32_t> on_face;
  for (std::size_t n = 0; n < mesh.nodes.size(); ++n)
    if (mesh.nodes[n][normal] == position) on_face.push_back(static_cast<std::int32_t>(n));
  return on_face;
}

}  // namespace gabion::coupler
