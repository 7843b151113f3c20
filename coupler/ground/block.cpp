#include "coupler/ground/block.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <map>
#include <stdexcept>
#include <utility>

namespace gabion::coupler {

namespace {

constexpr double level_cell = 0.25;           // m, as in the rigid-box reference
constexpr double level_sides = 2.0;           // of the block: the square round it that counts, full of grains in every model
constexpr double level_cell_diameters = 1.5;  // finer grains: cells as large beside them as in that reference
constexpr int sphere_refinements = 2;         // of an icosahedron: 320 faces
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

/// Corners about the origin and faces of them, three or four a face, anticlockwise from outside.
struct Shape {
  std::vector<Eigen::Vector3d> vertices;
  std::vector<std::vector<std::int32_t>> faces;
};

Shape cube(double side) {
  static constexpr int corners[8][3] = {{-1, -1, -1}, {1, -1, -1}, {1, 1, -1}, {-1, 1, -1}, {-1, -1, 1}, {1, -1, 1}, {1, 1, 1}, {-1, 1, 1}};
  Shape shape;
  for (const auto& c : corners) shape.vertices.push_back(0.5 * side * Eigen::Vector3d(c[0], c[1], c[2]));
  shape.faces = {{0, 3, 2, 1}, {4, 5, 6, 7}, {0, 1, 5, 4}, {2, 3, 7, 6}, {1, 2, 6, 5}, {0, 4, 7, 3}};
  return shape;
}

Shape icosahedron() {
  const double golden = 0.5 * (1.0 + std::sqrt(5.0)), edge = 2.0 / std::sqrt(1.0 + golden * golden), slack = 1.0 + 1e-9;
  Shape shape;
  for (const double a : {-1.0, 1.0})
    for (const double b : {-golden, golden})
      for (const Eigen::Vector3d& v : {Eigen::Vector3d(0, a, b), Eigen::Vector3d(a, b, 0), Eigen::Vector3d(b, 0, a)})
        shape.vertices.push_back(v.normalized());
  const auto near = [&](std::size_t i, std::size_t j) { return (shape.vertices[i] - shape.vertices[j]).norm() < slack * edge; };
  const std::size_t count = shape.vertices.size();
  for (std::size_t i = 0; i < count; ++i)
    for (std::size_t j = i + 1; j < count; ++j)
      for (std::size_t k = j + 1; k < count; ++k)
        if (near(i, j) && near(j, k) && near(i, k))
          shape.faces.push_back({static_cast<std::int32_t>(i), static_cast<std::int32_t>(j), static_cast<std::int32_t>(k)});
  return shape;
}

/// Each triangle parted in four, new corners on the unit sphere.
void refine(Shape& shape) {
  std::map<std::pair<std::int32_t, std::int32_t>, std::int32_t> middles;
  const auto middle = [&](std::int32_t i, std::int32_t j) {
    const std::pair<std::int32_t, std::int32_t> side = std::minmax(i, j);
    const auto [found, made] = middles.try_emplace(side, static_cast<std::int32_t>(shape.vertices.size()));
    if (made) {
      const Eigen::Vector3d between = shape.vertices[static_cast<std::size_t>(i)] + shape.vertices[static_cast<std::size_t>(j)];
      shape.vertices.push_back(between.normalized());
    }
    return found->second;
  };
  std::vector<std::vector<std::int32_t>> finer;
  for (const auto& f : shape.faces) {
    const std::int32_t a = middle(f[0], f[1]), b = middle(f[1], f[2]), c = middle(f[2], f[0]);
    finer.insert(finer.end(), {{f[0], a, c}, {f[1], b, a}, {f[2], c, b}, {a, b, c}});
  }
  shape.faces = std::move(finer);
}

/// Polyhedron of many triangles with the volume of the sphere.
Shape sphere(double diameter) {
  Shape shape = icosahedron();
  for (int round = 0; round < sphere_refinements; ++round) refine(shape);
  double six_volumes = 0.0;
  for (auto& f : shape.faces) {
    const auto at = [&](std::size_t k) -> const Eigen::Vector3d& { return shape.vertices[static_cast<std::size_t>(f[k])]; };
    const double signed_volume = at(0).dot(at(1).cross(at(2)));
    six_volumes += std::fabs(signed_volume);
    if (signed_volume < 0.0) std::swap(f[1], f[2]);
  }
  const double six_balls = 8.0 * std::acos(-1.0), scale = 0.5 * diameter * std::cbrt(six_balls / six_volumes);
  for (Eigen::Vector3d& v : shape.vertices) v *= scale;
  return shape;
}

/// Distance of a point from the block's surface in the block's own axes, m; negative inside.
double distance_from(const scene::Block& block, const Eigen::Vector3d& x) {
  return block.shape == "sphere" ? x.norm() - 0.5 * block.side : distance_from_cube(x, 0.5 * block.side);
}

/// Height of the centre at which a block that comes down on the grains first touches one. The smallest gap is a distance
/// that the block can go down without meeting a grain (sphere tracing: Hart 1996).
double touching_height(const scene::Block& block, const Eigen::Matrix3d& turn, const GrainSet& grains) {
  const double reach = 0.5 * block.side * std::sqrt(3.0);
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
      gap = std::min(gap, distance_from(block, turn.transpose() * from) - grains.radius[g]);
    }
    height -= gap;
    if (gap < touching_tolerance * block.side) return height;
  }
  throw std::runtime_error("block.position: no grain lies under the block; move it over grains.zone");
}

}  // namespace

double mean_surface_level(const scene::Box& ground, const GrainSet& grains, const scene::Block& block) {
  double sum_of_radii = 0.0;
  for (const double r : grains.radius) sum_of_radii += r;
  const double cell = std::min(level_cell, level_cell_diameters * 2.0 * sum_of_radii / static_cast<double>(grains.radius.size()));
  const int nx = std::max(1, static_cast<int>((ground.hi[0] - ground.lo[0]) / cell));
  const int ny = std::max(1, static_cast<int>((ground.hi[1] - ground.lo[1]) / cell));
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
  for (int j = 0; j < ny; ++j)
    for (int i = 0; i < nx; ++i) {
      const double x = ground.lo[0] + (i + 0.5) * (ground.hi[0] - ground.lo[0]) / nx;
      const double y = ground.lo[1] + (j + 0.5) * (ground.hi[1] - ground.lo[1]) / ny;
      const double h = top[static_cast<std::size_t>(j) * nx + i];
      const double away = std::max(std::fabs(x - block.position[0]), std::fabs(y - block.position[1]));
      if (away > level_sides * block.side || h <= deep) continue;
      sum += h;
      count += 1.0;
    }
  return count > 0.0 ? sum / count : ground.hi[2];
}

PlacedBlock place_block(const scene::Block& block, const scene::Box& ground, const GrainSet& grains) {
  const bool round = block.shape == "sphere";
  const Eigen::Matrix3d turn = round ? Eigen::Matrix3d::Identity() : attitude(block.tip);
  const Shape shape = round ? sphere(block.side) : cube(block.side);
  std::vector<Eigen::Vector3d> vertices;
  double lowest = 0.0;
  for (const Eigen::Vector3d& v : shape.vertices) {
    vertices.push_back(turn * v);
    lowest = std::min(lowest, vertices.back()[2]);
  }
  PlacedBlock placed;
  double height = block.position[2];
  if (block.touching) height = touching_height(block, turn, grains);
  for (const Eigen::Vector3d& v : vertices) placed.vertices.push_back({block.position[0] + v[0], block.position[1] + v[1], height + v[2]});
  placed.face_ptr.push_back(0);
  for (const auto& face : shape.faces) {
    placed.face_vertices.insert(placed.face_vertices.end(), face.begin(), face.end());
    placed.face_ptr.push_back(static_cast<std::int32_t>(placed.face_vertices.size()));
  }
  placed.lowest = height + lowest;
  placed.surface_level = mean_surface_level(ground, grains, block);
  return placed;
}

}  // namespace gabion::coupler
