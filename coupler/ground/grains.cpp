#include "coupler/ground/grains.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <stdexcept>
#include <string>
#include <tuple>

#include "coupler/ground/loose_grains.hpp"

namespace gabion::coupler {

namespace {

constexpr double on_plane = 1e-9;            // lattice planes on a face count as inside
constexpr double whole_cells = 1e-6;         // how far a periodic side may be from a whole number of cells
constexpr double touching = 1e-6;            // bonding gap of lattices
constexpr double block_of_diameters = 4.0;   // grains are ordered block by block, for locality
constexpr double widest_edge_reach = 1.25;   // edge_hats

bool inside(const Box& box, const Point& x) {
  for (int axis = 0; axis < 3; ++axis)
    if (x[axis] < box.lo[axis] || x[axis] > box.hi[axis]) return false;
  return true;
}

}  // namespace

double Packing::mean_diameter() const {
  return 2.0 * std::accumulate(radius.begin(), radius.end(), 0.0) / static_cast<double>(radius.size());
}

Packing make_lattice(const scene::Scene& scene) {
  const bool fcc = scene.grains.packing == "fcc";
  const double cell_per_radius = fcc ? 2.0 * std::sqrt(2.0) : 2.0;
  const Box& box = scene.ground.box;
  double radius = scene.grains.radius.at(0);
  double cell = cell_per_radius * radius;
  int fitted = -1;
  for (int axis = 0; axis < 3; ++axis) {
    if (!scene.ground.periodic[axis]) continue;
    const double length = box.hi[axis] - box.lo[axis];
    if (fitted < 0) {
      cell = length / std::max(1.0, std::round(length / cell));
      radius = cell / cell_per_radius;
      fitted = axis;
    }
    const double cells = length / cell;
    if (std::fabs(cells - std::round(cells)) > whole_cells * cells)
      throw std::runtime_error("ground.box: the periodic side along " + std::string(1, "xyz"[axis]) + " holds " +
                               std::to_string(cells) + " lattice cells; make it a whole number (a cell is " +
                               std::to_string(cell) + " m)");
  }
  Packing packing;
  packing.gap = touching;
  std::array<int, 3> cells;
  for (int axis = 0; axis < 3; ++axis) {
    const double count = (box.hi[axis] - box.lo[axis]) / cell;
    cells[axis] = static_cast<int>(scene.ground.periodic[axis] ? std::lround(count) - 1 : std::floor(count + whole_cells));
  }
  static constexpr double basis[4][3] = {{0, 0, 0}, {0.5, 0.5, 0}, {0.5, 0, 0.5}, {0, 0.5, 0.5}};
  for (int k = 0; k <= cells[2]; ++k)
    for (int j = 0; j <= cells[1]; ++j)
      for (int i = 0; i <= cells[0]; ++i)
        for (int b = 0; b < (fcc ? 4 : 1); ++b) {
          const std::array<int, 3> index{i, j, k};
          Point x;
          bool keep = true;
          for (int axis = 0; axis < 3; ++axis) {
            x[axis] = box.lo[axis] + cell * (index[axis] + basis[b][axis]);
            if (!scene.ground.periodic[axis]) keep = keep && x[axis] <= box.hi[axis] + on_plane * cell;
          }
          if (!keep) continue;
          packing.position.push_back(x);
          packing.radius.push_back(radius);
        }
  packing.contacts_per_grain = fcc ? 12 : 6;
  const double pi = std::acos(-1.0);
  packing.solid_fraction = (fcc ? 4.0 : 1.0) * 4.0 / 3.0 * pi * std::pow(radius / cell, 3);
  return packing;
}

namespace {

/// One flag a grain: in the zone, and held there by enough contacts or by the tie.
std::vector<char> kept_grains(const Packing& packing, const scene::Ground& ground, const Zone& zone, const Cut& cut) {
  std::vector<char> kept(packing.radius.size(), 1), held(packing.radius.size(), 0);
  if (!zone.has_interface()) return kept;
  for (std::size_t i = 0; i < kept.size(); ++i) {
    const double r = packing.radius[i], beyond = zone.beyond_outer(packing.position[i]);
    kept[i] = beyond <= (cut.edge ? cut.reach * r : on_plane * r);
    held[i] = cut.edge ? std::fabs(beyond) < cut.reach * r : cut.slaved && zone.overlap_share(packing.position[i], r) > 0.0;
  }
  drop_loose_grains(contact_pairs(packing, ground), held, cut.min_contacts, kept);
  return kept;
}

}  // namespace

std::vector<std::int32_t> select_grains(const Packing& packing, const scene::Ground& ground, const Zone& zone, const Cut& cut) {
  struct Key {
    bool interior;
    std::array<int, 3> block;
    std::int32_t grain;
  };
  const double block = block_of_diameters * packing.mean_diameter();
  std::vector<Key> keys;
  const std::vector<char> kept = kept_grains(packing, ground, zone, cut);
  for (std::size_t i = 0; i < packing.position.size(); ++i) {
    if (!kept[i]) continue;
    const Point& x = packing.position[i];
    const double r = packing.radius[i];
    bool interior = true;
    if (zone.has_interface())
      interior = cut.edge ? std::fabs(zone.beyond_outer(x)) > std::max(cut.reach, widest_edge_reach) * r
                          : zone.overlap_share(x, r) == 0.0;
    Key key{interior, {}, static_cast<std::int32_t>(i)};
    for (int axis = 0; axis < 3; ++axis) key.block[axis] = static_cast<int>(std::floor(x[axis] / block));
    keys.push_back(key);
  }
  std::sort(keys.begin(), keys.end(), [](const Key& a, const Key& b) {
    return std::tie(a.interior, a.block[2], a.block[1], a.block[0], a.grain) <
           std::tie(b.interior, b.block[2], b.block[1], b.block[0], b.grain);
  });
  std::vector<std::int32_t> selected;
  for (const Key& key : keys) selected.push_back(key.grain);
  return selected;
}

std::int32_t material_at(const scene::Scene& scene, const Point& x) {
  std::string name = scene.ground.material;
  for (const scene::Fill& fill : scene.fills)
    if (inside(fill.box, x)) name = fill.material;
  for (std::size_t m = 0; m < scene.materials.size(); ++m)
    if (scene.materials[m].name == name) return static_cast<std::int32_t>(m);
  throw std::runtime_error("material '" + name + "' is not defined");
}

}  // namespace gabion::coupler
