#include "coupler/ground/block.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace gabion::coupler {

namespace {

constexpr double level_cell = 0.25;   // m, as in the rigid-box reference
constexpr double touching_tolerance = 1e-9;  // of the side
constexpr int most_approaches = 1000;

/// Turns a cube with faces along the axes so that corner, edge or face points down.
Eigen::Matrix3d attitude(const std::string& tip) {
  if (tip == "face") return Eigen::Matrix3d::Identity();
  const Eigen::Vector3d lowest = tip == "edge" ? Eigen::Vector3d(0, -1, -1) : Eigen::Vector3d(-1, -1, -1);
  return Eigen::Quaterniond::FromTwoVectors(lowest.normalized(), -Eigen::Vector3d::UnitZ()).toRotationMatrix();
}

/// Distance of a point from a cube of the given half side about the origin, m; negative inside.
double distance_from_cube(const Eigen::Vector3d& x, double half_side) {
  const Eigen::Vector3d beyond = x.cwiseAbs() - Eigen::Vector3d::Constant(half_side);
  return beyond.cwiseMax(0.0).norm() + std::min(beyond.maxCoeff(), 0.0);
}

/// Height of the centre at which a cube that comes down on the grains first touches one. The smallest gap is a distance
/// that the cube can go down without meeting a grain (sphere tracing: Hart 1996).
double touching_height(const scene::Block& block, const Eigen::Matrix3d& turn, const GrainSet& grains) {
  const double half = 0.5 * block.side, reach = half * std::sqrt(3.0);
  std::vector<std::size_t> near;
  double height = -scene::infinity, floor = scene::infinity;
  for (std::size_t g = 0; g < grains.position.size(); ++g) {
    const Point& x = grains.position[g];
    const double r = grains.radius[g];
    if (std::hypot(x[0] - block.position[0], x[1] - block.position[1]) > reach + r) continue;
    near.push_back(g);
    height = std::max(height, x[2] + r + reach);
    floor = std::min(floor, x[2] - r - reach);
  }
  for (int k = 0; k < most_approaches && height > floor; ++k) {
    double gap = scene::infinity;
    for (const std::size_t g : near) {
      const Point& x = grains.position[g];
      const Eigen::Vector3d from(x[0] - block.position[0], x[1] - block.position[1], x[2] - height);
      gap = std::min(gap, distance_from_cube(turn.transpose() * from, half) - grains.radius[g]);
    }
    height -= gap;
    if (gap < touching_tolerance * block.side) return height;
  }
  throw std::runtime_error("block.position: no grain lies under the block; move it over grains.zone");
}

}  // namespace

double mean_surface_level(const scene::Box& ground, const GrainSet& grains) {
  const int nx = std::max(1, static_cast<int>((ground.hi[0] - ground.lo[0]) / level_cell));
  const int ny = std::max(1, static_cast<int>((ground.hi[1] - ground.lo[1]) / level_cell));
  std::vector<double> top(static_cast<std::size_t>(nx) * ny, -scene::infinity);
  for (std::size_t g = 0; g < grains.position.size(); ++g) {
    const Point& x = grains.position[g];
    const int i = static_cast<int>((x[0] - ground.lo[0]) / (ground.hi[0] - ground.lo[0]) * nx);
    const int j = static_cast<int>((x[1] - ground.lo[1]) / (ground.hi[1] - ground.lo[1]) * ny);
    if (i < 0 || j < 0 || i >= nx || j >= ny) continue;
    double& highest = top[static_cast<std::size_t>(j) * nx + i];
    highest = std::max(highest, x[2] + grains.radius[g]);
  }
  double sum = 0.0, count = 0.0;
  const double deep = 0.5 * (ground.lo[2] + ground.hi[2]);
  for (const double h : top)
    if (h > deep) {
      sum += h;
      count += 1.0;
    }
  return count > 0.0 ? sum / count : ground.hi[2];
}

PlacedBlock place_block(const scene::Block& block, const scene::Box& ground, const GrainSet& grains) {
  static constexpr int corners[8][3] = {{-1, -1, -1}, {1, -1, -1}, {1, 1, -1}, {-1, 1, -1}, {-1, -1, 1}, {1, -1, 1}, {1, 1, 1}, {-1, 1, 1}};
  static constexpr int faces[6][4] = {{0, 3, 2, 1}, {4, 5, 6, 7}, {0, 1, 5, 4}, {2, 3, 7, 6}, {1, 2, 6, 5}, {0, 4, 7, 3}};
  const Eigen::Matrix3d turn = attitude(block.tip);
  std::vector<Eigen::Vector3d> vertices;
  double lowest = 0.0;
  for (const auto& c : corners) {
    vertices.push_back(turn * (0.5 * block.side * Eigen::Vector3d(c[0], c[1], c[2])));
    lowest = std::min(lowest, vertices.back()[2]);
  }
  PlacedBlock placed;
  double height = block.position[2];
  if (block.touching) height = touching_height(block, turn, grains);
  for (const Eigen::Vector3d& v : vertices) placed.vertices.push_back({block.position[0] + v[0], block.position[1] + v[1], height + v[2]});
  placed.face_ptr.push_back(0);
  for (const auto& face : faces) {
    placed.face_vertices.insert(placed.face_vertices.end(), std::begin(face), std::end(face));
    placed.face_ptr.push_back(static_cast<std::int32_t>(placed.face_vertices.size()));
  }
  placed.lowest = height + lowest;
  placed.surface_level = mean_surface_level(ground, grains);
  return placed;
}

}  // namespace gabion::coupler
