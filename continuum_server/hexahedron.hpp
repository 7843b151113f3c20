#pragma once
// The eight-node hexahedron of any shape: what is integrated once, at set-up, on 2 x 2 x 2 Gauss points.
//
// Source: enhanced assumed strains (Simo & Rifai 1990, eq. 3.6 to 3.12), with the free strains of brick.hpp
// as parameters alpha, so that a rectangular element has exactly the brick's stiffness:
//
//   strain   eps = B u + (j0/j) T0 E(xi) alpha      E: xx,xy,zx by xi; yy,xy,yz by eta; zz,yz,zx by zeta;
//                                                      yy,zz,yz by eta zeta; zz,xx,zx by zeta xi; xx,yy,xy by xi eta
//   energy   1/2 sum_g w_g j_g eps.C eps,   stationary in alpha:   K = K_uu - K_ua K_aa^-1 K_au
//
//   j, j0  Jacobian determinant at the point, at the centre [m3]   T0  natural to Cartesian strains at the centre
//   B      strain of the nodal displacements [1/m]                 C   stiffness [Pa]
//
// The mean of the second term is zero, whatever the shape, so the patch test is passed exactly.

#include <array>
#include <cstddef>

#include "continuum_server/material.hpp"
#include "continuum_server/mesh.hpp"

namespace gabion::continuum {

/// 24 x 24, symmetric, N/m; row 3 corner + axis.
using ElementStiffness = std::array<double, 24 * 24>;

/// The element's corners must pass smallest_corner_jacobian() > 0.
ElementStiffness condensed_stiffness(const Corners& corners, const SolidMaterial& material);

/// One integration point.
struct GaussPoint {
  Vec position;                 ///< m
  double volume;                ///< weight times Jacobian, m3
  std::array<double, 8> shape;  ///< N_J
};
std::array<GaussPoint, 8> gauss_points(const Corners& corners);

/// Strain at the centre, Voigt, engineering shears; u in the order of the corners.
std::array<double, 6> centre_strain(const Corners& corners, const std::array<Vec, 8>& u);

}  // namespace gabion::continuum
