#pragma once
// Areas of the ground's faces, shared out to grains and nodes: for tractions, pressures and absorbers.
//
// Grains: a grid of rays of pitch r_min/4 normal to the face; the first grain hit within two diameters takes
// the cell's area. The areas are then corrected by a + b y + c z so that total area and first moments are exact.
// Nodes: integral of the shape functions over the faces of the elements. Where grains and elements overlap each
// gets its weight, w and 1 - w.

#include <cstdint>
#include <vector>

#include "coupler/ground/grains.hpp"
#include "coupler/ground/mesh.hpp"

namespace gabion::coupler {

struct Patch {
  std::vector<std::int32_t> entities;
  std::vector<double> area;  ///< m2

  double total() const;
};

/// face: 0 to 5 for xmin ... zmax. zone: weights; grains stand inside its outer box only.
Patch grain_patch(int face, const Box& ground, const std::array<bool, 3>& periodic, const Zone& zone,
                  const GrainSet& grains);
Patch mesh_patch(int face, const HexMesh& mesh, const Zone& zone);

/// Grains that rest against a face: what a rigid plate would hold.
std::vector<std::int32_t> grains_at_face(int face, const Box& ground, const GrainSet& grains);
std::vector<std::int32_t> nodes_at_face(int face, const HexMesh& mesh);

}  // namespace gabion::coupler
