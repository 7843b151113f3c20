#pragma once
// The isotropic elasticity nearest to a stiffness.

#include <Eigen/Dense>

namespace gabion::dem {

/// Voigt order xx yy zz yz zx xy, engineering shear strains, Pa.
using Stiffness = Eigen::Matrix<double, 6, 6>;

struct Isotropic {
  double young = 0.0;  ///< Pa
  double poisson = 0.0;
  double bulk = 0.0;   ///< Pa
  double shear = 0.0;  ///< Pa
  /// Norm of what is not isotropic over the norm of the stiffness, both as fourth-order tensors.
  double misfit = 0.0;
};

/// Orthogonal projection in the norm of fourth-order tensors (Moakher & Norris 2006):
///   9 K = C_iijj,   30 G = 3 C_ijij - C_iijj
Isotropic isotropic_part(const Stiffness& stiffness);

Stiffness isotropic_stiffness(double young, double poisson);

}  // namespace gabion::dem
