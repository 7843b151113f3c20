#include <Eigen/Dense>
#include <catch2/catch.hpp>

#include "coupler/ground/face_layers.hpp"
#include "tests/coupler/sample.hpp"

using namespace sample;
using coupler::FaceLayers;
using coupler::face_layers;

namespace {

constexpr double hole_top = 12.0, top = 24.0;  // the sample has elements above 12 m; its face zmax is the sixth

const Ground& ground() {
  static const Ground g = Ground::make(half, 3.0, 1.5, false);
  return g;
}

std::array<double, 3> share_of(const FaceLayers& layers, std::size_t element) {
  return layers.share[static_cast<std::size_t>(layers.material[element])];
}

/// What a column of elements through a point gives way under unit stress and modulus.
double compliance(const FaceLayers& layers, double x, double y, double from, double to) {
  const coupler::HexMesh& mesh = ground().mesh;
  double total = 0.0;
  for (std::size_t e = 0; e < mesh.cells.size(); ++e) {
    const Point centre = mesh.grid.cell_centre(mesh.cells[e]);
    const auto& z = mesh.grid.lines(2);
    const auto k = static_cast<std::size_t>(mesh.cells[e][2]);
    const bool here = mesh.grid.locate({x, y, centre[2]}) == mesh.cells[e] && z[k] >= from - 1e-9 && z[k + 1] <= to + 1e-9;
    if (here) total += (z[k + 1] - z[k]) * share_of(layers, e)[2];
  }
  return total;
}

}  // namespace

TEST_CASE("no offset leaves the mesh as it is", "[face_layers]") {
  const FaceLayers layers = face_layers(ground().mesh, {});
  CHECK(layers.share == std::vector<std::array<double, 3>>{{1, 1, 1}});
  CHECK(layers.material == std::vector<std::int32_t>(ground().mesh.elements.size(), 0));
}

TEST_CASE("a held face shortens or lengthens the mesh by its offset", "[face_layers]") {
  for (const double offset : {0.3, 0.9, -0.4, 1e-6}) {
    const FaceLayers layers = face_layers(ground().mesh, {0, 0, 0, 0, 0, offset});
    CHECK(compliance(layers, 6, 6, hole_top, top) == Approx(top - hole_top - offset).epsilon(1e-12));
    for (const auto& share : layers.share) {
      CHECK(share[2] >= 0.75 - 1e-12);
      CHECK(share[2] <= 1.25 + 1e-12);
    }
  }
}

TEST_CASE("a layer is as many elements thick as four offsets take", "[face_layers]") {
  const coupler::HexMesh& mesh = ground().mesh;
  for (const double offset : {0.3, 0.9}) {
    const FaceLayers layers = face_layers(mesh, {0, 0, 0, 0, 0, offset});
    double lowest = top;
    for (std::size_t e = 0; e < mesh.cells.size(); ++e)
      if (layers.material[e] != 0) lowest = std::min(lowest, mesh.grid.lines(2)[static_cast<std::size_t>(mesh.cells[e][2])]);
    CHECK(top - lowest >= 4.0 * offset);
    CHECK(top - lowest - 1.5 - 1e-9 < 4.0 * offset);
  }
}

TEST_CASE("where layers meet each counts along its own axis", "[face_layers]") {
  const FaceLayers layers = face_layers(ground().mesh, {0.2, 0, 0, 0.1, 0, 0.3});
  const FaceLayers x = face_layers(ground().mesh, {0.2, 0, 0, 0, 0, 0}), y = face_layers(ground().mesh, {0, 0, 0, 0.1, 0, 0}),
                   z = face_layers(ground().mesh, {0, 0, 0, 0, 0, 0.3});
  for (std::size_t e = 0; e < layers.material.size(); ++e)
    CHECK(share_of(layers, e) == std::array<double, 3>{share_of(x, e)[0], share_of(y, e)[1], share_of(z, e)[2]});
}

TEST_CASE("across its face a layer is stiffer by 1/s, along it as stiff as the ground", "[face_layers]") {
  Eigen::Matrix<double, 6, 6> random = Eigen::Matrix<double, 6, 6>::Random();
  const Eigen::Matrix<double, 6, 6> positive = random * random.transpose() + 0.5 * Eigen::Matrix<double, 6, 6>::Identity();
  coupler::Stiffness ground_stiffness;
  for (int i = 0; i < 6; ++i)
    for (int j = 0; j < 6; ++j) ground_stiffness[i][j] = positive(i, j);
  const auto matrix = [](const coupler::Stiffness& c) {
    Eigen::Matrix<double, 6, 6> m;
    for (int i = 0; i < 6; ++i)
      for (int j = 0; j < 6; ++j) m(i, j) = c[i][j];
    return m;
  };
  CHECK(coupler::layer_stiffness(ground_stiffness, {1, 1, 1}) == ground_stiffness);
  const Eigen::Matrix<double, 6, 6> compliance = matrix(ground_stiffness).inverse();
  const int across[3][3] = {{0, 4, 5}, {1, 3, 5}, {2, 3, 4}}, along[3][3] = {{1, 2, 3}, {0, 2, 4}, {0, 1, 5}};
  for (int axis = 0; axis < 3; ++axis)
    for (const double s : {0.75, 1.25}) {
      std::array<double, 3> share{1, 1, 1};
      share[axis] = s;
      const Eigen::Matrix<double, 6, 6> layer = matrix(coupler::layer_stiffness(ground_stiffness, share));
      CHECK(layer.eigenvalues().real().minCoeff() > 0.0);
      // sides held: only strain across the face
      const Eigen::Matrix3d ratio = layer(across[axis], across[axis]) * s - positive(across[axis], across[axis]);
      CHECK(ratio.norm() < 1e-12 * positive.norm());
      // no stress across the face: the compliance along it
      const Eigen::Matrix3d change = layer.inverse()(along[axis], along[axis]) - compliance(along[axis], along[axis]);
      CHECK(change.norm() < 1e-10 * compliance.norm());
    }
}
