#include "continuum_server/hexahedron.hpp"

#include <Eigen/Dense>
#include <cmath>

#include "continuum_server/hadamard.hpp"

namespace gabion::continuum {

namespace {

using Eigen::Matrix3d;
using Matrix6 = Eigen::Matrix<double, 6, 6, Eigen::RowMajor>;
using StrainOperator = Eigen::Matrix<double, 6, 24>;
constexpr int free_strains = 18;
using FreeOperator = Eigen::Matrix<double, 6, free_strains>;

/// Axes (first, second) of each Voigt component.
constexpr int voigt[6][2] = {{0, 0}, {1, 1}, {2, 2}, {1, 2}, {2, 0}, {0, 1}};

using Natural = std::array<double, 3>;

Natural gauss_position(int point) {
  const double at = 1.0 / std::sqrt(3.0);
  return {at * corner_sign(point, 0), at * corner_sign(point, 1), at * corner_sign(point, 2)};
}

double shape(int corner, const Natural& xi) {
  double value = 0.125;
  for (int axis = 0; axis < 3; ++axis) value *= 1.0 + corner_sign(corner, axis) * xi[axis];
  return value;
}

/// dN_J/dxi, row J.
Eigen::Matrix<double, 8, 3> shape_slopes(const Natural& xi) {
  Eigen::Matrix<double, 8, 3> slopes;
  for (int corner = 0; corner < 8; ++corner)
    for (int axis = 0; axis < 3; ++axis) {
      double value = 0.125 * corner_sign(corner, axis);
      for (int other = 0; other < 3; ++other)
        if (other != axis) value *= 1.0 + corner_sign(corner, other) * xi[other];
      slopes(corner, axis) = value;
    }
  return slopes;
}

/// dx_i/dxi_a, row i.
Matrix3d jacobian(const Corners& corners, const Eigen::Matrix<double, 8, 3>& slopes) {
  Matrix3d j = Matrix3d::Zero();
  for (int corner = 0; corner < 8; ++corner)
    for (int i = 0; i < 3; ++i)
      for (int a = 0; a < 3; ++a) j(i, a) += corners[corner][i] * slopes(corner, a);
  return j;
}

StrainOperator strain_operator(const Eigen::Matrix<double, 8, 3>& gradient) {
  StrainOperator b = StrainOperator::Zero();
  for (int corner = 0; corner < 8; ++corner)
    for (int v = 0; v < 6; ++v) {
      const auto [r, s] = std::pair{voigt[v][0], voigt[v][1]};
      b(v, 3 * corner + r) += gradient(corner, s);
      if (r != s) b(v, 3 * corner + s) += gradient(corner, r);
    }
  return b;
}

/// Natural (covariant) to Cartesian strains: eps = J^-T E J^-1, in Voigt form.
Matrix6 to_cartesian(const Matrix3d& inverse) {
  Matrix6 t;
  for (int v = 0; v < 6; ++v)
    for (int n = 0; n < 6; ++n) {
      const int r = voigt[v][0], s = voigt[v][1], a = voigt[n][0], b = voigt[n][1];
      double value = inverse(a, r) * inverse(b, s);
      if (a != b) value = 0.5 * (value + inverse(b, r) * inverse(a, s));
      t(v, n) = (r != s ? 2.0 : 1.0) * value;
    }
  return t;
}

/// The free strains at a point, natural axes.
FreeOperator free_operator(const Natural& xi) {
  FreeOperator m = FreeOperator::Zero();
  int column = 0;
  for (int i = 0; i < 3; ++i) {
    const int j = (i + 1) % 3, k = (i + 2) % 3;
    for (const int v : {i, 3 + k, 3 + j}) m(v, column++) = xi[i];
    for (const int v : {j, k, 3 + i}) m(v, column++) = xi[j] * xi[k];
  }
  return m;
}

}  // namespace

ElementStiffness condensed_stiffness(const Corners& corners, const SolidMaterial& material) {
  const Matrix6 c = Eigen::Map<const Matrix6>(material.stiffness.data());
  const Matrix3d centre = jacobian(corners, shape_slopes({0, 0, 0}));
  const double j0 = centre.determinant();
  const Matrix6 t0 = to_cartesian(centre.inverse());

  using Matrix24 = Eigen::Matrix<double, 24, 24>;
  Matrix24 k_uu = Matrix24::Zero();
  Eigen::Matrix<double, free_strains, 24> k_au = Eigen::Matrix<double, free_strains, 24>::Zero();
  Eigen::Matrix<double, free_strains, free_strains> k_aa = Eigen::Matrix<double, free_strains, free_strains>::Zero();
  for (int point = 0; point < 8; ++point) {
    const Natural xi = gauss_position(point);
    const auto slopes = shape_slopes(xi);
    const Matrix3d here = jacobian(corners, slopes);
    const double j = here.determinant();
    const StrainOperator b = strain_operator(slopes * here.inverse());
    const FreeOperator free = (j0 / j) * t0 * free_operator(xi);
    k_uu += j * b.transpose() * c * b;
    k_au += j * free.transpose() * c * b;
    k_aa += j * free.transpose() * c * free;
  }
  const Matrix24 k = k_uu - k_au.transpose() * k_aa.ldlt().solve(k_au);
  ElementStiffness result;
  for (int r = 0; r < 24; ++r)
    for (int s = 0; s < 24; ++s) result[24 * r + s] = 0.5 * (k(r, s) + k(s, r));
  return result;
}

std::array<GaussPoint, 8> gauss_points(const Corners& corners) {
  std::array<GaussPoint, 8> points;
  for (int p = 0; p < 8; ++p) {
    const Natural xi = gauss_position(p);
    GaussPoint& point = points[p];
    point.volume = jacobian(corners, shape_slopes(xi)).determinant();
    point.position = Vec{};
    for (int corner = 0; corner < 8; ++corner) {
      point.shape[corner] = shape(corner, xi);
      point.position += engine::splat(point.shape[corner]) * corners[corner];
    }
  }
  return points;
}

std::array<double, 6> centre_strain(const Corners& corners, const std::array<Vec, 8>& u) {
  const auto slopes = shape_slopes({0, 0, 0});
  const Matrix3d gradient = jacobian(u, slopes) * jacobian(corners, slopes).inverse();  // du_i/dx_s
  std::array<double, 6> strain;
  for (int v = 0; v < 6; ++v) {
    const int r = voigt[v][0], s = voigt[v][1];
    strain[v] = r == s ? gradient(r, r) : gradient(r, s) + gradient(s, r);
  }
  return strain;
}

}  // namespace gabion::continuum
