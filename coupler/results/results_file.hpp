#pragma once
// results.h5: the states of a run. Layout in docs/results.md. Beside it results.xdmf grows with every state, and
// close writes grains.vtkhdf and mesh.vtkhdf.
//
//   ResultsFile results(folder.file("results.h5"));
//   results.write_grain_geometry({...});  results.write_mesh_geometry({...});
//   results.begin_state(time, step, stage);
//     results.grain_field("displacement", u, 3, "m");  results.node_field(...);  results.cell_field(...);
//   results.end_state();
//
// Everything up to the last end_state survives whatever ends the process. Every call throws ResultsError with
// the dataset's name: wrong sizes, a call out of order, a full disk.

#include <array>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <span>
#include <string>

namespace gabion::coupler {

/// Spheres at rest. The arrays must have n entries (position 3 n); weight, origin_id and clump may be empty.
struct GrainGeometry {
  std::span<const double> position;         ///< [n][3] m
  std::span<const double> radius;           ///< [n] m
  std::span<const std::int32_t> material;   ///< [n]
  std::span<const std::int64_t> origin_id;  ///< [n] number in the packing, the same in every model of a scene
  std::span<const double> weight;           ///< [n] share that the grains carry, 1 outside the overlap
  std::span<const std::int32_t> clump = {}; ///< [n] number of the clump, -1 for single grains
};

/// Bricks at rest. wrap, period as in drawn_mesh; material, weight may be empty.
struct MeshGeometry {
  std::span<const double> nodes;           ///< [n][3] m
  std::span<const std::int32_t> elements;  ///< [m][8]
  std::span<const std::uint8_t> wrap;      ///< [m][8] or empty
  std::array<double, 3> period{};          ///< m
  std::span<const std::int32_t> material;  ///< [m]
  std::span<const double> weight;          ///< [m] share that the element carries, 1 outside the overlap
};

/// The block's faces: face_ptr, face_vertices as in the BLOCK message.
struct BlockGeometry {
  std::span<const double> vertices;  ///< [n][3] m, at the start
  std::span<const std::int32_t> face_ptr, face_vertices;
};

class ResultsFile {
 public:
  /// Creates path, and path with the ending .xdmf.
  explicit ResultsFile(const std::filesystem::path& path);
  ResultsFile(ResultsFile&&) noexcept;
  ResultsFile& operator=(ResultsFile&&) noexcept;
  /// Closes, and keeps quiet about errors: call close to hear of them.
  ~ResultsFile();

  /// Attribute of the file: scene, model, version ...
  void attribute(const std::string& key, const std::string& text);

  // Once each, before the first state; what a model has not got is left out.
  void write_grain_geometry(const GrainGeometry& grains);
  void write_mesh_geometry(const MeshGeometry& mesh);
  /// position [rows][3]: where each constraint row acts, m.
  void write_interface_geometry(std::span<const double> position);
  void write_block_geometry(const BlockGeometry& block);

  void begin_state(double time, std::uint64_t step, const std::string& stage = "");
  // values [n][components]; six components are a symmetric tensor in the order xx yy zz yz zx xy and are stored in
  // the order xx yy zz xy yz xz that ParaView expects. unit is kept as an attribute.
  void grain_field(const std::string& name, std::span<const double> values, int components,
                   const std::string& unit = "");
  /// n is the mesh's own number of nodes.
  void node_field(const std::string& name, std::span<const double> values, int components,
                  const std::string& unit = "");
  void cell_field(const std::string& name, std::span<const double> values, int components,
                  const std::string& unit = "");
  /// n is the number of constraint rows: jump, multiplier_force ...
  void interface_field(const std::string& name, std::span<const double> values, int components,
                       const std::string& unit = "");
  /// Contacts of this state, [m][8] as the grain engine's field "contact": grain, grain, normal (3), force on the
  /// second (3, N, weight included). Goes to /contacts/state_..., which is not drawn.
  void contacts(std::span<const double> rows);
  /// Present corners [n][3], m.
  void block_vertices(std::span<const double> vertices);
  void end_state();

  std::uint64_t states() const;
  /// Writes the .vtkhdf files and closes; further calls throw. Closing twice is allowed.
  void close();

 private:
  struct Content;
  std::unique_ptr<Content> content_;
};

}  // namespace gabion::coupler
