#include "coupler/results/xdmf.hpp"

#include <fstream>

#include "coupler/results/errors.hpp"
#include "coupler/results/history.hpp"
#include "coupler/results/run_folder.hpp"

namespace gabion::coupler {

namespace {

const std::string head =
    "<?xml version=\"1.0\"?>\n<Xdmf Version=\"3.0\">\n<Domain>\n"
    "<Grid Name=\"states\" GridType=\"Collection\" CollectionType=\"Temporal\">\n";
const std::string closing_tags = "</Grid>\n</Domain>\n</Xdmf>\n";

std::string item(const std::string& data, const std::string& dataset, const std::string& extent, bool integer) {
  return "<DataItem Dimensions=\"" + extent + "\" NumberType=\"" + (integer ? "Int" : "Float") +
         "\" Precision=\"8\" Format=\"HDF\">" + data + ":" + dataset + "</DataItem>";
}

std::string array(const std::string& data, const DrawnGrid& grid, const DrawnArray& drawn) {
  // Six and more components as Matrix: Tensor6 would be reordered by the reader of XDMF 2.
  const char* kind = drawn.components == 1 ? "Scalar" : drawn.components == 3 ? "Vector" : "Matrix";
  std::string extent = std::to_string(drawn.on_cells ? grid.cell_count : grid.point_count);
  if (drawn.components > 1) extent.append(" ").append(std::to_string(drawn.components));
  return "<Attribute Name=\"" + drawn.name + "\" AttributeType=\"" + kind + "\" Center=\"" +
         (drawn.on_cells ? "Cell" : "Node") + "\">" + item(data, drawn.dataset, extent, drawn.integer) +
         "</Attribute>\n";
}

std::string uniform_grid(const std::string& data, const DrawnGrid& grid) {
  const std::string cells = std::to_string(grid.cell_count), per_cell = std::to_string(grid.nodes_per_cell);
  std::string text = "<Grid Name=\"" + grid.name + "\" GridType=\"Uniform\">\n<Topology TopologyType=\"";
  text += grid.nodes_per_cell == 1 ? "Polyvertex\" NodesPerElement=\"1" : "Hexahedron";
  text += "\" NumberOfElements=\"" + cells + "\">" + item(data, grid.connectivity, cells + " " + per_cell, true) +
          "</Topology>\n<Geometry GeometryType=\"XYZ\">" +
          item(data, grid.points, std::to_string(grid.point_count) + " 3", false) + "</Geometry>\n";
  for (const DrawnArray& drawn : grid.arrays) text += array(data, grid, drawn);
  return text + "</Grid>\n";
}

}  // namespace

XdmfFile::XdmfFile(std::filesystem::path path, std::string data)
    : path_(std::move(path)), data_(std::move(data)), tail_(head.size()) {
  write_atomically(path_, head + closing_tags);
}

void XdmfFile::append(double time, const std::vector<DrawnGrid>& grids) {
  std::string text = "<Grid Name=\"state\" GridType=\"Collection\" CollectionType=\"Spatial\">\n<Time Value=\"" +
                     shortest(time) + "\"/>\n";
  for (const DrawnGrid& grid : grids) text += uniform_grid(data_, grid);
  write_at_tail(text + "</Grid>\n");
}

// One write over the closing tags keeps the cost of a state the same however many there are.
void XdmfFile::write_at_tail(const std::string& text) {
  std::fstream file(path_, std::ios::binary | std::ios::in | std::ios::out);
  file.seekp(static_cast<std::streamoff>(tail_));
  const std::string whole = text + closing_tags;
  file.write(whole.data(), static_cast<std::streamsize>(whole.size()));
  file.flush();
  if (!file) throw ResultsError(path_.string() + ": cannot write (disk full, or no permission)");
  tail_ += text.size();
}

}  // namespace gabion::coupler
