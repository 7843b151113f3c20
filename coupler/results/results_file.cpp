#include "coupler/results/results_file.hpp"

#include <algorithm>
#include <cstdio>
#include <vector>

#include "coupler/results/errors.hpp"
#include "coupler/results/hdf5.hpp"
#include "coupler/results/mesh_corners.hpp"
#include "coupler/results/vtkhdf.hpp"
#include "coupler/results/xdmf.hpp"

namespace gabion::coupler {

namespace {

constexpr std::size_t tensor_components = 6;
// xx yy zz yz zx xy -> xx yy zz xy yz xz
constexpr std::array<std::size_t, tensor_components> drawn_tensor_order = {0, 1, 2, 5, 3, 4};

std::string state_name(std::uint64_t index) {
  char text[32];
  std::snprintf(text, sizeof text, "state_%06llu", static_cast<unsigned long long>(index));
  return text;
}

std::vector<std::int64_t> widened(std::span<const std::int32_t> values) { return {values.begin(), values.end()}; }

std::vector<double> in_drawn_order(std::span<const double> tensors) {
  std::vector<double> values(tensors.size());
  for (std::size_t k = 0; k < tensors.size(); k += tensor_components)
    for (std::size_t c = 0; c < tensor_components; ++c) values[k + c] = tensors[k + drawn_tensor_order[c]];
  return values;
}

const DrawnArray* find(const DrawnGrid& grid, const DrawnArray& like) {
  for (const DrawnArray& array : grid.arrays)
    if (array.name == like.name && array.on_cells == like.on_cells && array.components == like.components)
      return &array;
  return nullptr;
}

/// VTKHDF wants the same arrays at every state: drops those that some state lacks.
void keep_common_arrays(std::vector<DrawnGrid>& states) {
  if (states.empty()) return;
  std::vector<DrawnArray> common;
  for (const DrawnArray& array : states.front().arrays)
    if (std::all_of(states.begin(), states.end(), [&](const DrawnGrid& state) { return find(state, array); }))
      common.push_back(array);
  for (DrawnGrid& state : states) {
    std::vector<DrawnArray> ordered;
    for (const DrawnArray& array : common) ordered.push_back(*find(state, array));
    state.arrays = std::move(ordered);
  }
}

/// /grains, /mesh, /interface or /block: rows that do not change and one subgroup a state.
struct Part {
  std::string name;
  hdf5::Handle group, state;
  DrawnGrid fixed;                ///< geometry and the arrays that do not change
  std::vector<DrawnGrid> states;  ///< the same with each state's arrays
  bool drawn = false;             ///< stands in the XDMF and VTKHDF files

  bool present() const { return group.open(); }
  std::string path(const std::string& leaf) const { return "/" + name + "/" + leaf; }
};

}  // namespace

struct ResultsFile::Content {
  std::filesystem::path path;
  hdf5::Handle file;
  hdf5::Column time, step;
  XdmfFile xdmf;
  Part grains{"grains", {}, {}, {}, {}, true}, mesh{"mesh", {}, {}, {}, {}, true};
  Part interface{"interface", {}, {}, {}, {}, false}, block{"block", {}, {}, {}, {}, false};
  Part contacts{"contacts", {}, {}, {}, {}, false};
  std::uint64_t row_count = 0, corner_count = 0, own_nodes = 0;
  std::vector<std::int64_t> node_source;
  std::vector<double> times;
  std::uint64_t step_number = 0;
  bool in_state = false;

  std::array<Part*, 5> parts() { return {&grains, &mesh, &interface, &block, &contacts}; }

  Part& create(Part& part) {
    if (part.present()) throw ResultsError("results: the geometry of " + part.name + " was written before");
    if (in_state || !times.empty())
      throw ResultsError("results: the geometry of " + part.name + " comes before the first state");
    part.group = hdf5::group(file, part.name);
    part.fixed.name = part.name;
    return part;
  }

  void fixed_array(Part& part, const std::string& name, std::span<const std::int64_t> values, bool on_cells) {
    if (values.empty()) return;
    const std::uint64_t rows = on_cells ? part.fixed.cell_count : part.fixed.point_count;
    hdf5::write(part.group, name, values, {rows});
    part.fixed.arrays.push_back({name, part.path(name), 1, on_cells, true});
  }
  void fixed_array(Part& part, const std::string& name, std::span<const double> values, bool on_cells) {
    if (values.empty()) return;
    const std::uint64_t rows = on_cells ? part.fixed.cell_count : part.fixed.point_count;
    hdf5::write(part.group, name, values, {rows});
    part.fixed.arrays.push_back({name, part.path(name), 1, on_cells, false});
  }

  void field(Part& part, const std::string& name, std::span<const double> values, int components,
             const std::string& unit, std::uint64_t rows, bool on_cells) {
    if (!in_state) throw ResultsError("results: field " + part.name + "/" + name + " outside begin_state, end_state");
    if (!part.present())
      throw ResultsError("results: field " + part.name + "/" + name + " without geometry of " + part.name);
    if (components < 1 || values.size() != rows * static_cast<std::uint64_t>(components))
      throw ResultsError("results: field " + part.name + "/" + name + " has " + std::to_string(values.size()) +
                         " values, expected " + std::to_string(rows) + " x " + std::to_string(components));
    std::vector<double> changed;
    if (components == static_cast<int>(tensor_components)) values = changed = in_drawn_order(values);
    std::vector<double> repeated;
    if (&part == &mesh && !on_cells && node_source.size() != own_nodes) {
      values = repeated = gather(values, static_cast<std::size_t>(components), node_source);
      rows = node_source.size();
    }
    hdf5::Extent extent{rows};
    if (components > 1) extent.push_back(static_cast<hsize_t>(components));
    if (!part.state.open()) part.state = hdf5::group(part.group, state_name(times.size() - 1));
    hdf5::write(part.state, name, values, extent);
    if (!unit.empty()) hdf5::attribute(part.state, name, "unit", unit);
    if (part.drawn)
      part.states.back().arrays.push_back({name, part.path(state_name(times.size() - 1) + "/" + name),
                                           static_cast<std::uint64_t>(components), on_cells, false});
  }
};

ResultsFile::ResultsFile(const std::filesystem::path& path) : content_(std::make_unique<Content>()) {
  Content& c = *content_;
  c.path = path;
  c.file = hdf5::create_file(path);
  hdf5::attribute(c.file, ".", "format", std::string("gabion results 1"));
  const hdf5::Handle states = hdf5::group(c.file, "states");
  c.time = hdf5::Column(states, "time", H5T_IEEE_F64LE);
  c.step = hdf5::Column(states, "step", H5T_STD_U64LE);
  c.xdmf = XdmfFile(std::filesystem::path(path).replace_extension(".xdmf"), path.filename().string());
  hdf5::check(H5Fflush(c.file, H5F_SCOPE_GLOBAL), "flush " + path.string());
}

ResultsFile::ResultsFile(ResultsFile&&) noexcept = default;
ResultsFile& ResultsFile::operator=(ResultsFile&&) noexcept = default;

ResultsFile::~ResultsFile() {
  try {
    if (content_) close();
  } catch (const std::exception&) {
  }
}

void ResultsFile::attribute(const std::string& key, const std::string& text) {
  hdf5::attribute(content_->file, ".", key, text);
}

void ResultsFile::write_grain_geometry(const GrainGeometry& grains) {
  Content& c = *content_;
  Part& part = c.create(c.grains);
  const std::uint64_t count = grains.radius.size();
  hdf5::write(part.group, "position", grains.position, {count, 3});
  std::vector<std::int64_t> vertices(count);
  for (std::size_t k = 0; k < count; ++k) vertices[k] = static_cast<std::int64_t>(k);
  hdf5::write(part.group, "connectivity", vertices, {count, 1});
  part.fixed.points = part.path("position");
  part.fixed.connectivity = part.path("connectivity");
  part.fixed.point_count = part.fixed.cell_count = count;
  c.fixed_array(part, "radius", grains.radius, false);
  c.fixed_array(part, "material", widened(grains.material), false);
  c.fixed_array(part, "origin_id", grains.origin_id, false);
  c.fixed_array(part, "weight", grains.weight, false);
  c.fixed_array(part, "clump", widened(grains.clump), false);
}

void ResultsFile::write_mesh_geometry(const MeshGeometry& mesh) {
  Content& c = *content_;
  Part& part = c.create(c.mesh);
  const DrawnMesh drawn = drawn_mesh(mesh.nodes, mesh.elements, mesh.wrap, mesh.period);
  c.node_source = drawn.source;
  c.own_nodes = mesh.nodes.size() / 3;
  part.fixed.point_count = drawn.source.size();
  part.fixed.nodes_per_cell = 8;
  part.fixed.cell_count = mesh.elements.size() / part.fixed.nodes_per_cell;
  hdf5::write(part.group, "nodes", drawn.nodes, {part.fixed.point_count, 3});
  hdf5::write(part.group, "elements", drawn.corners, {part.fixed.cell_count, part.fixed.nodes_per_cell});
  part.fixed.points = part.path("nodes");
  part.fixed.connectivity = part.path("elements");
  c.fixed_array(part, "node", drawn.source, false);
  c.fixed_array(part, "material", widened(mesh.material), true);
  c.fixed_array(part, "weight", mesh.weight, true);
}

void ResultsFile::write_interface_geometry(std::span<const double> position) {
  Content& c = *content_;
  Part& part = c.create(c.interface);
  c.row_count = position.size() / 3;
  hdf5::write(part.group, "position", position, {c.row_count, 3});
}

void ResultsFile::write_block_geometry(const BlockGeometry& block) {
  Content& c = *content_;
  Part& part = c.create(c.block);
  c.corner_count = block.vertices.size() / 3;
  hdf5::write(part.group, "vertices", block.vertices, {c.corner_count, 3});
  hdf5::write(part.group, "face_ptr", block.face_ptr, {block.face_ptr.size()});
  hdf5::write(part.group, "face_vertices", block.face_vertices, {block.face_vertices.size()});
}

void ResultsFile::begin_state(double time, std::uint64_t step, const std::string& stage) {
  Content& c = *content_;
  if (!c.file.open()) throw ResultsError("results: begin_state after close");
  if (c.in_state) throw ResultsError("results: begin_state twice without end_state");
  const std::string name = "states/" + state_name(c.times.size());
  const hdf5::Handle state = hdf5::group(c.file, name);
  hdf5::attribute(state, ".", "time", time);
  hdf5::attribute(state, ".", "stage", stage);
  c.in_state = true;
  c.times.push_back(time);
  c.step_number = step;
  for (Part* part : c.parts())
    if (part->drawn && part->present()) part->states.push_back(part->fixed);
}

void ResultsFile::grain_field(const std::string& name, std::span<const double> values, int components,
                              const std::string& unit) {
  content_->field(content_->grains, name, values, components, unit, content_->grains.fixed.point_count, false);
}

void ResultsFile::node_field(const std::string& name, std::span<const double> values, int components,
                             const std::string& unit) {
  content_->field(content_->mesh, name, values, components, unit, content_->own_nodes, false);
}

void ResultsFile::cell_field(const std::string& name, std::span<const double> values, int components,
                             const std::string& unit) {
  content_->field(content_->mesh, name, values, components, unit, content_->mesh.fixed.cell_count, true);
}

void ResultsFile::interface_field(const std::string& name, std::span<const double> values, int components,
                                  const std::string& unit) {
  content_->field(content_->interface, name, values, components, unit, content_->row_count, false);
}

void ResultsFile::contacts(std::span<const double> rows) {
  Content& c = *content_;
  if (!c.in_state) throw ResultsError("results: contacts outside begin_state, end_state");
  constexpr std::size_t width = 8;
  if (rows.size() % width != 0) throw ResultsError("results: contacts have " + std::to_string(rows.size()) + " values, not a multiple of 8");
  const std::size_t count = rows.size() / width;
  std::vector<std::int32_t> grains;
  std::vector<double> normal, force;
  for (std::size_t k = 0; k < count; ++k) {
    const double* row = &rows[width * k];
    grains.insert(grains.end(), {static_cast<std::int32_t>(row[0]), static_cast<std::int32_t>(row[1])});
    normal.insert(normal.end(), row + 2, row + 5);
    force.insert(force.end(), row + 5, row + 8);
  }
  if (!c.contacts.group.open()) c.contacts.group = hdf5::group(c.file, c.contacts.name);
  c.contacts.state = hdf5::group(c.contacts.group, state_name(c.times.size() - 1));
  hdf5::write(c.contacts.state, "grains", grains, {count, 2});
  hdf5::write(c.contacts.state, "normal", normal, {count, 3});
  hdf5::write(c.contacts.state, "force", force, {count, 3});
  hdf5::attribute(c.contacts.state, "force", "unit", std::string("N"));
}

void ResultsFile::block_vertices(std::span<const double> vertices) {
  content_->field(content_->block, "vertices", vertices, 3, "m", content_->corner_count, false);
}

void ResultsFile::end_state() {
  Content& c = *content_;
  if (!c.in_state) throw ResultsError("results: end_state without begin_state");
  c.in_state = false;
  std::vector<DrawnGrid> grids;
  for (Part* part : c.parts()) {
    part->state.reset();
    if (part->drawn && part->present()) grids.push_back(part->states.back());
  }
  c.time.append(c.times.back());
  c.step.append(c.step_number);
  hdf5::check(H5Fflush(c.file, H5F_SCOPE_GLOBAL), "flush " + c.path.string());
  c.xdmf.append(c.times.back(), grids);  // only now: the XDMF file never names an array that is not on disk
}

std::uint64_t ResultsFile::states() const { return content_->times.size(); }

void ResultsFile::close() {
  Content& c = *content_;
  if (!c.file.open()) return;
  if (c.in_state) c.times.pop_back();  // a state that was begun and not ended does not count
  for (Part* part : c.parts()) {
    part->state.reset();
    part->group.reset();
    part->states.resize(part->drawn && part->fixed.point_count ? c.times.size() : 0);
    keep_common_arrays(part->states);
  }
  c.in_state = false;
  c.time = {};
  c.step = {};
  c.file.reset();
  for (const Part* part : {&c.grains, &c.mesh})
    write_vtkhdf(std::filesystem::path(c.path).replace_filename(part->name + ".vtkhdf"), c.path.filename().string(),
                 c.times, part->states);
}

}  // namespace gabion::coupler
