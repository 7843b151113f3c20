#include "coupler/scene/geometry.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace gabion::scene {

const std::array<std::string, 6> face_names = {"xmin", "xmax", "ymin", "ymax", "zmin", "zmax"};

double tolerance(const Box& box) {
  constexpr double relative = 1e-9;
  double largest = 0.0;
  for (int axis = 0; axis < 3; ++axis)
    largest = std::max({largest, box.hi[axis] - box.lo[axis], std::abs(box.lo[axis]), std::abs(box.hi[axis])});
  return relative * largest;
}

bool contains(const Box& box, const Point& point, double slack) {
  for (int axis = 0; axis < 3; ++axis)
    if (point[axis] < box.lo[axis] - slack || point[axis] > box.hi[axis] + slack) return false;
  return true;
}

bool is_interface(const Scene& scene, int face) {
  if (!scene.grains.zone) return false;
  const double inward =
      (face_coordinate(*scene.grains.zone, face) - face_coordinate(scene.ground.box, face)) * (face % 2 == 0 ? 1 : -1);
  return inward > tolerance(scene.ground.box);
}

double cell_over_radius(const std::string& packing) {
  return packing == "fcc" ? 2 * std::sqrt(2.0) : 2.0;
}

double depth_below_centre(const Block& block) {
  const double half = block.side / 2;
  if (block.tip == "face" || block.shape == "sphere") return half;
  return half * std::sqrt(block.tip == "edge" ? 2.0 : 3.0);
}

double end_of(const History& history) {
  const auto& p = history.parameters;
  if (history.kind == "ramp" || history.kind == "half_sine") return p[1] + p[2];
  if (history.kind == "table") return p[p.size() - 2];
  return 0.0;
}

History shifted(const History& history, double by) {
  History later = history;
  if (history.kind == "ramp" || history.kind == "half_sine") later.parameters[1] += by;
  if (history.kind == "table")
    for (std::size_t i = 0; i < later.parameters.size(); i += 2) later.parameters[i] += by;
  return later;
}

const Material& Scene::material(const std::string& wanted) const {
  const auto found =
      std::find_if(materials.begin(), materials.end(), [&](const Material& m) { return m.name == wanted; });
  if (found == materials.end()) throw std::out_of_range("the scene has no material '" + wanted + "'");
  return *found;
}

std::string to_string(Model model) {
  static const std::string names[] = {"dem", "continuum", "bridging", "edge"};
  return names[static_cast<int>(model)];
}

bool is_lattice(const Grains& grains) {
  return grains.packing == "fcc" || grains.packing == "sc";
}

double mean_diameter(const Grains& grains) {
  const auto& r = grains.radius;
  if (r.empty()) return 0.0;
  if (grains.radius_kind == "uniform") return r.front() + r.back();
  // between two sieves the mass is uniform in the radius: numbers go with r^-3 dr
  double count = 0.0, length = 0.0;
  for (std::size_t i = 0; i + 3 < r.size(); i += 2) {
    const double a = r[i], b = r[i + 2], density = (r[i + 3] - r[i + 1]) / (b - a);
    count += 0.5 * density * (1 / (a * a) - 1 / (b * b));
    length += 2 * density * (1 / a - 1 / b);
  }
  return length / count;
}

}  // namespace gabion::scene
