#include "coupler/ground/face_layers.hpp"

#include <cmath>
#include <map>

namespace gabion::coupler {

namespace {

constexpr double offsets_per_layer = 4.0;  // keeps the factor between 0.8 and 1.34

struct Layer {
  int cells = 0;
  double factor = 1.0;
};

Layer layer_at(const Grid& grid, int face, double offset) {
  const int axis = face / 2, all = grid.cells(axis);
  const std::vector<double>& lines = grid.lines(axis);
  const auto place = [&](int k) { return lines[static_cast<std::size_t>(face % 2 == 0 ? k : all - k)]; };
  Layer layer;
  double thickness = 0.0;
  while (layer.cells < all && thickness < offsets_per_layer * std::fabs(offset))
    thickness = std::fabs(place(++layer.cells) - place(0));
  if (layer.cells > 0 && thickness > offset) layer.factor = thickness / (thickness - offset);
  return layer;
}

}  // namespace

FaceLayers face_layers(const HexMesh& mesh, const std::array<double, 6>& offset) {
  FaceLayers layers;
  std::array<Layer, 6> at_face;
  for (int face = 0; face < 6; ++face) at_face[static_cast<std::size_t>(face)] = layer_at(mesh.grid, face, offset[static_cast<std::size_t>(face)]);
  std::map<std::uint32_t, std::int32_t> material_of{{0, 0}};  // by the faces in whose layers an element lies
  for (const Cell& cell : mesh.cells) {
    std::uint32_t faces = 0;
    double factor = 1.0;
    for (int face = 0; face < 6; ++face) {
      const int axis = face / 2, depth = face % 2 == 0 ? cell[axis] : mesh.grid.cells(axis) - 1 - cell[axis];
      const Layer& layer = at_face[static_cast<std::size_t>(face)];
      if (depth >= layer.cells) continue;
      faces |= 1u << face;
      factor *= layer.factor;
    }
    const auto [known, fresh] = material_of.try_emplace(faces, static_cast<std::int32_t>(layers.factor.size()));
    if (fresh) layers.factor.push_back(factor);
    layers.material.push_back(known->second);
  }
  return layers;
}

}  // namespace gabion::coupler
