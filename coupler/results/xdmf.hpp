#pragma once
// results.xdmf: tells ParaView (XDMF 2 and 3 readers) where in results.h5 each state's arrays are. One temporal
// collection; each entry holds the grids "grains" and "mesh".

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>


namespace gabion::coupler {

/// One array of a grid in the results file.
struct DrawnArray {
  std::string name;
  std::string dataset;  ///< path in results.h5
  std::uint64_t components = 1;
  bool on_cells = false;
  bool integer = false;
};

/// One grid: points, cells of one kind, arrays.
struct DrawnGrid {
  std::string name;          ///< grains or mesh
  std::string points;        ///< dataset [n][3]
  std::string connectivity;  ///< dataset [cells][nodes per cell]
  std::uint64_t point_count = 0, cell_count = 0, nodes_per_cell = 1;
  std::vector<DrawnArray> arrays;
};

class XdmfFile {
 public:
  XdmfFile() = default;
  /// data: name of the HDF5 file beside it. Throws ResultsError when it cannot be written.
  XdmfFile(std::filesystem::path path, std::string data);
  /// The file on disk is complete after each call.
  void append(double time, const std::vector<DrawnGrid>& grids);

 private:
  void write_at_tail(const std::string& text);
  std::filesystem::path path_;
  std::string data_;
  std::uint64_t tail_ = 0;  ///< where the closing tags start
};

}  // namespace gabion::coupler
