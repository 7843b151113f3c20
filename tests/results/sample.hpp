#pragma once
// A small run with every kind of array: three grains, two periodic bricks, two constraint rows, a block.

#include <filesystem>
#include <vector>

#include "coupler/results/results_file.hpp"

namespace sample {

inline const std::vector<double> position = {0, 0, 0, 1, 0, 0, 0, 1, 0};
inline const std::vector<double> radius = {0.1, 0.2, 0.3};
inline const std::vector<double> nodes = {0, 0, 0, 0, 1, 0, 0, 0, 1, 0, 1, 1, 1, 0, 0, 1, 1, 0, 1, 0, 1, 1, 1, 1};
inline const std::vector<std::int32_t> elements = {0, 4, 5, 1, 2, 6, 7, 3, 4, 0, 1, 5, 6, 2, 3, 7};
inline const std::vector<std::uint8_t> wrap = {0, 0, 0, 0, 0, 0, 0, 0, 0, 1, 1, 0, 0, 1, 1, 0};

inline std::vector<double> counted(std::size_t count, double from) {
  std::vector<double> values(count);
  for (std::size_t k = 0; k < count; ++k) values[k] = from + static_cast<double>(k);
  return values;
}

inline void geometry(gabion::coupler::ResultsFile& file) {
  const std::vector<std::int32_t> grain_material = {0, 1, 0}, solid_material = {2, 3};
  const std::vector<std::int64_t> origin_id = {7, 8, 9};
  const std::vector<double> weight = {1, 0.5, 0.01}, solid_weight = {0.5, 1};
  file.write_grain_geometry({position, radius, grain_material, origin_id, weight});
  file.write_mesh_geometry({nodes, elements, wrap, {2.0, 0.0, 0.0}, solid_material, solid_weight});
  file.write_interface_geometry(std::vector<double>{0, 0, 0, 1, 1, 1});
  file.write_block_geometry({position, std::vector<std::int32_t>{0, 3}, std::vector<std::int32_t>{0, 1, 2}});
}

/// Displacements of grains count from 100 k, of nodes from 1000 k, stresses from 10 000 k.
inline void state_fields(gabion::coupler::ResultsFile& file, double k) {
  file.grain_field("displacement", counted(9, 100 * k), 3, "m");
  file.grain_field("broken_bonds", counted(3, k), 1);
  file.node_field("displacement", counted(24, 1000 * k), 3, "m");
  file.cell_field("stress", counted(12, 10000 * k), 6, "Pa");
  file.interface_field("jump", counted(6, k), 3, "m");
  file.block_vertices(counted(9, k));
}

inline void state(gabion::coupler::ResultsFile& file, int k) {
  file.begin_state(0.5 * k, static_cast<std::uint64_t>(10 * k), "impact");
  state_fields(file, k);
  file.end_state();
}

}  // namespace sample
