#pragma once
// The continuum's elastic constants: from a scene's material, or as measured on the packing.

#include <array>

namespace gabion::coupler {

/// Voigt order xx yy zz yz zx xy, engineering shear strains.
using Stiffness = std::array<std::array<double, 6>, 6>;

struct Elasticity {
  Stiffness stiffness{};  ///< Pa
  double density = 0.0;   ///< bulk, kg/m3
  /// How far inside the faces xmin, xmax ... zmax a continuum would have to be held to be as long as the grains, m.
  std::array<double, 6> face_offset{};
};

/// Throws std::invalid_argument unless young > 0 and -1 < poisson < 0.5.
Stiffness isotropic_stiffness(double young, double poisson);

struct IsotropicFit {
  double young;    ///< Pa
  double poisson;
  double misfit;   ///< Frobenius norm of what is left over the norm of the stiffness, in the Kelvin basis
};
/// The isotropic tensor nearest to a stiffness: K = C_iijj/9, G = (3 C_ijij - C_iijj)/30.
IsotropicFit isotropic_fit(const Stiffness& c);

/// Modulus of a plane P wave along an axis, Pa, and of the mean shear wave.
double p_modulus(const Stiffness& c, int axis);
double s_modulus(const Stiffness& c, int axis);

}  // namespace gabion::coupler
