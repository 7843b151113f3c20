#include "continuum_server/material.hpp"

#include <Eigen/Dense>
#include <cmath>
#include <string>

#include "protocol/engine/engine.hpp"

namespace gabion::continuum {

namespace {

using Matrix6 = Eigen::Matrix<double, 6, 6, Eigen::RowMajor>;

constexpr double symmetry_tolerance = 1e-9;  // of the largest entry

Matrix6 matrix(const SolidMaterial& material) {
  return Eigen::Map<const Matrix6>(material.stiffness.data());
}

/// Stiffness of the strains `kept` when the others are free to make the energy least.
Eigen::Matrix3d condensed(const Matrix6& c, const int (&kept)[3], const int (&free)[3]) {
  Eigen::Matrix3d pp, pq, qq;
  for (int r = 0; r < 3; ++r)
    for (int s = 0; s < 3; ++s) {
      pp(r, s) = c(kept[r], kept[s]);
      pq(r, s) = c(kept[r], free[s]);
      qq(r, s) = c(free[r], free[s]);
    }
  const Eigen::Matrix3d reduced = pp - pq * qq.llt().solve(pq.transpose());
  return 0.5 * (reduced + reduced.transpose());
}

}  // namespace

SolidMaterial isotropic(double young, double poisson, double density) {
  const double lame = young * poisson / ((1 + poisson) * (1 - 2 * poisson));
  const double shear = 0.5 * young / (1 + poisson);
  SolidMaterial material;
  material.density = density;
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) material.stiffness[6 * i + j] = lame + (i == j ? 2 * shear : 0.0);
    material.stiffness[7 * (i + 3)] = shear;
  }
  return material;
}

void check(const SolidMaterial& material, std::size_t index) {
  const std::string where = "SOLID_MATERIALS[" + std::to_string(index) + "].";
  if (!(material.density > 0.0) || !std::isfinite(material.density))
    throw engine::RequestError(where + "density", "density " + std::to_string(material.density) + " kg/m3",
                               "give a density above 0");
  const Matrix6 c = matrix(material);
  if (!c.allFinite())
    throw engine::RequestError(where + "stiffness", "an entry is not a finite number", "give 36 finite numbers, Pa");
  if ((c - c.transpose()).cwiseAbs().maxCoeff() > symmetry_tolerance * c.cwiseAbs().maxCoeff())
    throw engine::RequestError(where + "stiffness", "the matrix is not symmetric", "give the symmetric part");
  const double smallest = Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(c).eigenvalues()[0];
  if (!(smallest > 0.0))
    throw engine::RequestError(
        where + "stiffness",
        "the matrix is not positive definite (smallest eigenvalue " + std::to_string(smallest) + " Pa)",
        "check the constants; an isotropic material needs E > 0 and -1 < nu < 0.5");
}

BrickStiffness brick_stiffness(const SolidMaterial& material) {
  const Matrix6 c = matrix(material);
  BrickStiffness result;
  for (int r = 0; r < 6; ++r)
    for (int s = 0; s < 6; ++s) result.constant[r][s] = c(r, s);
  for (int i = 0; i < 3; ++i) {
    const int j = (i + 1) % 3, k = (i + 2) % 3;
    const int without_i[3] = {j, k, 3 + i}, with_i[3] = {i, 3 + k, 3 + j};
    const Eigen::Matrix3d linear = condensed(c, without_i, with_i) / 3.0;
    const Eigen::Matrix3d bilinear = condensed(c, with_i, without_i) / 9.0;
    for (int r = 0; r < 3; ++r)
      for (int s = 0; s < 3; ++s) {
        result.linear[i][r][s] = linear(r, s);
        result.bilinear[i][r][s] = bilinear(r, s);
      }
  }
  return result;
}

}  // namespace gabion::continuum
