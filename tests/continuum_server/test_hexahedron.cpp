#include <Eigen/Dense>
#include <catch2/catch.hpp>

#include "continuum_server/box_mesh.hpp"
#include "continuum_server/hexahedron.hpp"

using namespace gabion::continuum;
namespace engine = gabion::engine;

namespace {

using Matrix24 = Eigen::Matrix<double, 24, 24, Eigen::RowMajor>;

Matrix24 stiffness(const Corners& corners, const SolidMaterial& material) {
  const ElementStiffness k = condensed_stiffness(corners, material);
  return Eigen::Map<const Matrix24>(k.data());
}

int zero_modes(const Matrix24& k) {
  const auto values = Eigen::SelfAdjointEigenSolver<Matrix24>(k).eigenvalues().eval();
  int zeros = 0;
  for (int i = 0; i < 24; ++i) zeros += std::fabs(values[i]) < 1e-12 * values[23];
  return zeros;
}

Corners corners_of_single(Vec edges, double distortion) {
  Mesh mesh = box_mesh({1, 1, 1}, edges);
  distort(mesh, distortion);
  return corners_of(mesh, 0, Vec{});
}

}  // namespace

TEST_CASE("an element has exactly six zero modes, whatever its shape and Poisson's ratio") {
  for (const double poisson : {0.0, 0.3, 0.45, 0.4999}) {
    CAPTURE(poisson);
    const SolidMaterial soil = isotropic(1.0, poisson, 1.0);
    CHECK(zero_modes(stiffness(corners_of_single(engine::vec(1, 1, 1), 0.0), soil)) == 6);
    CHECK(zero_modes(stiffness(corners_of_single(engine::vec(1, 0.3, 2), 0.0), soil)) == 6);
    CHECK(zero_modes(stiffness(corners_of_single(engine::vec(1, 1, 1), 0.2), soil)) == 6);
  }
}

TEST_CASE("the strain at the centre of an affine motion is its strain, of any shape") {
  const Corners corners = corners_of_single(engine::vec(1, 0.7, 1.2), 0.2);
  std::array<Vec, 8> u;
  for (int c = 0; c < 8; ++c) {
    const Vec x = corners[c];
    u[c] = engine::vec(1e-3 * x[0] + 4e-3 * x[1], 2e-3 * x[1] + 5e-3 * x[2], 3e-3 * x[2] + 6e-3 * x[0]);
  }
  const auto strain = centre_strain(corners, u);
  const double expected[6] = {1e-3, 2e-3, 3e-3, 5e-3, 6e-3, 4e-3};
  for (int v = 0; v < 6; ++v) CHECK(strain[v] == Approx(expected[v]).epsilon(1e-12));
}

TEST_CASE("Gauss points share out the volume") {
  const Corners corners = corners_of_single(engine::vec(2, 3, 4), 0.0);
  double volume = 0.0, shared = 0.0;
  for (const GaussPoint& point : gauss_points(corners)) {
    volume += point.volume;
    for (const double n : point.shape) shared += n * point.volume;
  }
  CHECK(volume == Approx(24.0).epsilon(1e-14));
  CHECK(shared == Approx(24.0).epsilon(1e-14));
}
