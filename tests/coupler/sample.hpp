#pragma once
// A small ground for the interface tests: a lattice or loosely scattered grains, a zone, a mesh.

#include <random>

#include "coupler/ground/grains.hpp"
#include "coupler/ground/mesh.hpp"
#include "coupler/interface/multipliers.hpp"
#include "coupler/interface/rows.hpp"

namespace sample {

using namespace gabion;
using coupler::Point;

struct Ground {
  scene::Scene scene;
  coupler::Zone zone;
  coupler::HexMesh mesh;
  coupler::GrainSet grains;

  /// mean grain diameter 1; the ground is 12 x 12 x 24, zone and overlap as given.
  static Ground make(const scene::Box& zone_box, double overlap, double h, bool edge, unsigned seed = 1) {
    Ground g;
    g.scene.ground.box = {{0, 0, 0}, {12, 12, 24}};
    g.scene.mesh.size = h;
    g.zone = coupler::Zone(g.scene.ground.box, zone_box, edge ? 0.0 : overlap, 0.01);
    g.mesh = coupler::make_mesh(coupler::make_grid(g.scene, g.zone), g.zone);
    std::mt19937 random(seed);
    std::uniform_real_distribution<double> unit(0.0, 1.0);
    coupler::Packing packing;
    for (int k = 0; k < 24; ++k)
      for (int j = 0; j < 12; ++j)
        for (int i = 0; i < 12; ++i) {
          const double r = 1.0 / 3.0 + unit(random) / 3.0;
          packing.position.push_back({i + 0.3 + 0.4 * unit(random), j + 0.3 + 0.4 * unit(random), k + 0.3 + 0.4 * unit(random)});
          packing.radius.push_back(r);
        }
    for (const std::int32_t i : coupler::select_grains(packing, g.scene.ground, g.zone, {.edge = edge, .reach = 1.25, .min_contacts = 0})) {
      g.grains.position.push_back(packing.position[i]);
      g.grains.radius.push_back(packing.radius[i]);
      g.grains.plain_mass.push_back(4.0 / 3.0 * 3.14159265358979 * std::pow(packing.radius[i], 3));
    }
    return g;
  }

  coupler::InterfaceRows rows(const std::string& scheme, double reach = 0.9) const {
    return coupler::build_rows(scheme, mesh, zone, grains, reach);
  }
  coupler::Inertia grain_inertia() const { return inertia(grains.plain_mass); }
  coupler::Inertia node_inertia(double mass = 3.0) const { return inertia(std::vector<double>(mesh.nodes.size(), mass)); }

 private:
  static coupler::Inertia inertia(const std::vector<double>& mass) {
    coupler::Inertia result;
    for (const double m : mass) {
      result.mass.push_back({m, m, m});
      result.freedom.push_back({1, 1, 1});
    }
    return result;
  }
};

inline const scene::Box half{{0, 0, 0}, {12, 12, 15}};    // one plane, at z = 15
inline const scene::Box pit{{3, 3, 9}, {9, 9, 24}};       // five planes with edges and corners

}  // namespace sample
