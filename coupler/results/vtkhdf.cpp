#include "coupler/results/vtkhdf.hpp"

#include <algorithm>
#include <array>
#include <cstdint>

#include "coupler/results/hdf5.hpp"

namespace gabion::coupler {

namespace {

constexpr std::uint8_t vertex = 1, hexahedron = 12;  // VTK cell types

std::vector<std::int64_t> multiples(std::size_t count, std::uint64_t of) {
  std::vector<std::int64_t> values(count);
  for (std::size_t k = 0; k < count; ++k) values[k] = static_cast<std::int64_t>(k * of);
  return values;
}

void write_geometry(hid_t root, const std::string& data, const DrawnGrid& grid) {
  using hdf5::write;
  const std::array points{static_cast<std::int64_t>(grid.point_count)};
  const std::array cells{static_cast<std::int64_t>(grid.cell_count)};
  const std::array corners{static_cast<std::int64_t>(grid.cell_count * grid.nodes_per_cell)};
  write(root, "NumberOfPoints", std::span(points), {1});
  write(root, "NumberOfCells", std::span(cells), {1});
  write(root, "NumberOfConnectivityIds", std::span(corners), {1});
  hdf5::write_virtual(root, "Points", data, {grid.points}, {grid.point_count, 3}, H5T_IEEE_F64LE);

  hdf5::write_virtual(root, "Connectivity", data, {grid.connectivity}, {grid.cell_count * grid.nodes_per_cell},
                      H5T_STD_I64LE);
  write(root, "Offsets", multiples(grid.cell_count + 1, grid.nodes_per_cell), {grid.cell_count + 1});
  const std::vector<std::uint8_t> types(grid.cell_count, grid.nodes_per_cell == 1 ? vertex : hexahedron);
  write(root, "Types", types, {grid.cell_count});
}

}  // namespace

void write_vtkhdf(const std::filesystem::path& path, const std::string& data, const std::vector<double>& times,
                  const std::vector<DrawnGrid>& grids) {
  if (grids.empty()) return;
  std::filesystem::path draft = path;
  draft += ".tmp";
  {
    const hdf5::Handle file = hdf5::create_file(draft);
    const hdf5::Handle root = hdf5::group(file, "VTKHDF");
    const std::array<std::int64_t, 2> version{2, 0};
    hdf5::attribute(root, ".", "Version", std::span(version));
    hdf5::attribute(root, ".", "Type", std::string("UnstructuredGrid"));
    const DrawnGrid& grid = grids.front();
    write_geometry(root, data, grid);

    const hdf5::Handle steps = hdf5::group(root, "Steps");
    const std::array count{static_cast<std::int64_t>(times.size())};
    hdf5::attribute(steps, ".", "NSteps", std::span(count));
    hdf5::write(steps, "Values", times, {times.size()});
    hdf5::write(steps, "NumberOfParts", std::vector<std::int64_t>(times.size(), 1), {times.size()});
    for (const char* name : {"PartOffsets", "PointOffsets"})
      hdf5::write(steps, name, multiples(times.size(), 0), {times.size()});
    for (const char* name : {"CellOffsets", "ConnectivityIdOffsets"})
      hdf5::write(steps, name, multiples(times.size(), 0), {times.size(), 1});

    const hdf5::Handle point_data = hdf5::group(root, "PointData"), cell_data = hdf5::group(root, "CellData");
    const hdf5::Handle point_offsets = hdf5::group(steps, "PointDataOffsets");
    const hdf5::Handle cell_offsets = hdf5::group(steps, "CellDataOffsets");
    for (std::size_t k = 0; k < grid.arrays.size(); ++k) {
      const DrawnArray& array = grid.arrays[k];
      const std::uint64_t rows = array.on_cells ? grid.cell_count : grid.point_count;
      std::vector<std::string> sources;
      for (const DrawnGrid& state : grids) sources.push_back(state.arrays[k].dataset);
      // An array that is the same at every state is stored once.
      const bool fixed = std::equal(sources.begin() + 1, sources.end(), sources.begin());
      if (fixed) sources.resize(1);
      hdf5::Extent extent{rows};
      if (array.components > 1) extent.push_back(array.components);
      hdf5::write_virtual(array.on_cells ? cell_data : point_data, array.name, data, sources, extent,
                          array.integer ? H5T_STD_I64LE : H5T_IEEE_F64LE);
      hdf5::write(array.on_cells ? cell_offsets : point_offsets, array.name, multiples(times.size(), fixed ? 0 : rows),
                  {times.size()});
    }
  }
  std::filesystem::rename(draft, path);
}

}  // namespace gabion::coupler
