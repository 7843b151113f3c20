#pragma once
// Linear elasticity of the ground, and what the brick element makes of it.

#include <array>
#include <cstddef>

namespace gabion::continuum {

/// Voigt order xx yy zz yz zx xy, engineering shear strains.
struct SolidMaterial {
  std::array<double, 36> stiffness{};  ///< Pa, row by row; symmetric, positive definite
  double density = 0.0;                ///< kg/m3, above 0
};

/// Young's modulus Pa, Poisson's ratio (-1 to below 0.5), density kg/m3.
SolidMaterial isotropic(double young, double poisson, double density);

/// engine::RequestError naming SOLID_MATERIALS[index] and the field, unless the material is as above.
void check(const SolidMaterial& material, std::size_t index);

/// The stiffness per family of strain fields of the brick, the free strains of each family condensed out;
/// see brick.hpp. With i the axis and (i, j, k) cyclic:
///   constant    6 x 6
///   linear[i]   strains proportional to the coordinate i: jj, kk, jk;           includes 1/3
///   bilinear[i] strains proportional to the product of j and k: ii, ij, ki;     includes 1/9
struct BrickStiffness {
  double constant[6][6];
  double linear[3][3][3];
  double bilinear[3][3][3];
};

BrickStiffness brick_stiffness(const SolidMaterial& material);

}  // namespace gabion::continuum
