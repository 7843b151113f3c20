#pragma once
// The grains of a scene: lattices made here, random packings made by dem_server, and which of them a model keeps.

#include <cstdint>
#include <vector>

#include "coupler/ground/zone.hpp"
#include "coupler/interface/rows.hpp"
#include "coupler/scene/scene.hpp"

namespace gabion::coupler {

/// The ground's box full of grains; every model of a scene is a subset of it.
struct Packing {
  std::vector<Point> position;  ///< m
  std::vector<double> radius;   ///< m
  double gap = 0.0;             ///< grains are bonded up to this gap over the sum of the radii
  double contacts_per_grain = 0.0;
  double solid_fraction = 0.0;
  double residual_overlap = 0.0;
  std::uint64_t rattlers = 0;  ///< removed for having too few contacts

  double mean_diameter() const;
};

/// Face-centred or simple cubic lattice filling the ground from its lower corner. The radius is fitted so
/// that a whole number of cells spans the first periodic direction. Throws std::runtime_error when another
/// periodic direction is not a whole number of cells.
Packing make_lattice(const scene::Scene& scene);

/// How a zone's faces cut a packing.
struct Cut {
  bool edge = false;    ///< edge-to-edge: grains within reach radii beyond a face stay, tied
  double reach = 0.0;   ///< radii
  bool slaved = false;  ///< bridging with strict rows: every grain of the overlap is held
  std::uint32_t min_contacts = 3;
};

/// Grains of the packing that the model keeps, in an order that puts those near the interface first and
/// neighbours close together; those that the cut leaves with fewer than min_contacts contacts, and that no tie
/// holds, go too. Indices into the packing.
std::vector<std::int32_t> select_grains(const Packing& packing, const scene::Ground& ground, const Zone& zone, const Cut& cut);

/// Index into scene.materials for a grain at x: the last fill that holds it, else the ground's.
std::int32_t material_at(const scene::Scene& scene, const Point& x);

}  // namespace gabion::coupler
