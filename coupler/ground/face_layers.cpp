#include "coupler/ground/face_layers.hpp"

#include <Eigen/Dense>
#include <cmath>
#include <map>

namespace gabion::coupler {

namespace {

constexpr double offsets_per_layer = 4.0;  // keeps the share between 0.75 and 1.25

/// Voigt components across a face of each axis, and along it.
constexpr int across[3][3] = {{0, 4, 5}, {1, 3, 5}, {2, 3, 4}};
constexpr int along[3][3] = {{1, 2, 3}, {0, 2, 4}, {0, 1, 5}};

struct Layer {
  int cells = 0;
  double share = 1.0;
};

Layer layer_at(const Grid& grid, int face, double offset) {
  const int axis = face / 2, all = grid.cells(axis);
  const std::vector<double>& lines = grid.lines(axis);
  const auto place = [&](int k) { return lines[static_cast<std::size_t>(face % 2 == 0 ? k : all - k)]; };
  Layer layer;
  double thickness = 0.0;
  while (layer.cells < all && thickness < offsets_per_layer * std::fabs(offset))
    thickness = std::fabs(place(++layer.cells) - place(0));
  if (layer.cells > 0 && thickness > offset) layer.share = (thickness - offset) / thickness;
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
    std::array<double, 3> share{1, 1, 1};
    for (int face = 0; face < 6; ++face) {
      const int axis = face / 2, depth = face % 2 == 0 ? cell[axis] : mesh.grid.cells(axis) - 1 - cell[axis];
      const Layer& layer = at_face[static_cast<std::size_t>(face)];
      if (depth >= layer.cells) continue;
      faces |= 1u << face;
      share[static_cast<std::size_t>(axis)] *= layer.share;
    }
    const auto [known, fresh] = material_of.try_emplace(faces, static_cast<std::int32_t>(layers.share.size()));
    if (fresh) layers.share.push_back(share);
    layers.material.push_back(known->second);
  }
  return layers;
}

Stiffness layer_stiffness(const Stiffness& ground, const std::array<double, 3>& share) {
  Eigen::Matrix<double, 6, 6> c;
  for (int i = 0; i < 6; ++i)
    for (int j = 0; j < 6; ++j) c(i, j) = ground[static_cast<std::size_t>(i)][static_cast<std::size_t>(j)];
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const double s = share[axis];
    if (s == 1.0) continue;
    const Eigen::Matrix3d a = c(across[axis], across[axis]), b = c(across[axis], along[axis]);
    c(along[axis], along[axis]) -= (1.0 - s) * b.transpose() * a.ldlt().solve(b);
    c(across[axis], across[axis]) = a / s;
  }
  Stiffness layer;
  for (int i = 0; i < 6; ++i)
    for (int j = 0; j < 6; ++j) layer[static_cast<std::size_t>(i)][static_cast<std::size_t>(j)] = 0.5 * (c(i, j) + c(j, i));
  return layer;
}

}  // namespace gabion::coupler
