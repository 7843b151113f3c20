#pragma once
// The falling block: a cube on its corner, edge or face, set down where it first touches the grains.

#include <cstdint>
#include <vector>

#include "coupler/interface/rows.hpp"
#include "coupler/scene/scene.hpp"

namespace gabion::coupler {

struct PlacedBlock {
  std::vector<Point> vertices;  ///< m
  std::vector<std::int32_t> face_ptr, face_vertices;
  double surface_level = 0.0;   ///< mean height of the grains' tops, m; penetration is measured from here
  double lowest = 0.0;          ///< height of the lowest corner, m
};

/// grains: present positions. Throws std::runtime_error when no grain lies under the block.
PlacedBlock place_block(const scene::Block& block, const scene::Box& ground, const GrainSet& grains);

/// Height of the highest tops of grains, mean over the square cells of the ground's plan that lie within two sides of the
/// block: near the rim of a zone a cell misses grains. Cells without grains are left out.
double mean_surface_level(const scene::Box& ground, const GrainSet& grains, const scene::Block& block);

}  // namespace gabion::coupler
