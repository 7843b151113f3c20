#pragma once
// The rectangular brick: nodal forces of eight elements at once, f = K u, without locking and without
// hourglass modes.
//
// Source: eight-node brick with enhanced strains (Simo & Rifai 1990; the nine modes of Wilson, Taylor and
// co-workers 1973/76, and nine bilinear ones), condensed out in closed form. In the basis of hadamard.hpp the
// strain fields 1; xi, eta, zeta; eta zeta, zeta xi, xi eta are orthogonal over the brick, so that the
// stiffness falls apart. With i an axis, (i, j, k) cyclic, x_i the coordinate, a_i half the edge:
//
//   constant   e = sym grad of the 9 linear modes                         energy V/2 e.C e
//   x_i        e_jj, e_kk, g_jk  from the bilinear modes of x_i x_j, x_i x_k;  e_ii, g_ij, g_ki free
//                                                                          energy V/2 (1/3) p.C^lin_i p
//   x_j x_k    e_ii, g_ij, g_ki  from the trilinear modes, u/a_i;          e_jj, e_kk, g_jk free
//                                                                          energy V/2 (1/9) p.C^bil_i p
//
// "Free" strains are the incompatible ones: they take the value that makes the energy least, which leaves
// the condensed 3 x 3 matrices of BrickStiffness. What follows from the choice:
//   - no shear locking: in bending the parasitic shear g_ij of field x_i is free, and so is the lateral e_ii;
//   - no volumetric locking: every non-constant field has a free normal strain to keep the volume;
//   - exactly six zero eigenvalues: 6 constant strains, 9 bilinear modes (6 bending, 3 twists; the twist
//     strains have the determinant 2/(a b c)) and 3 trilinear ones all cost energy;
//   - patch test: free strains have no mean;
//   - uniform strains and plane waves along an axis see full integration, unchanged.
//
//   V  volume [m3]   share  1 - w, bridging weight [-]   u  displacements [m]   C  stiffness [Pa]

#include <cstddef>

#include "continuum_server/hadamard.hpp"
#include "continuum_server/lanes.hpp"
#include "continuum_server/material.hpp"

namespace gabion::continuum {

/// Eight bricks of one material. Lanes beyond the last element repeat lane 0 with scale 0.
struct BrickBatch {
  std::int32_t node[8][lane_count];  ///< by bits of the corner, see hadamard.hpp
  Lanes inverse[3];                  ///< 1/a_i, 1/m
  Lanes scale;                       ///< share V/64, m3
  std::int32_t material;
};

/// Modal coefficients to modal forces, without the lanes' scale; both [axis][mode], mode 0 unused.
inline void brick_modes(const BrickStiffness& c, const Lanes (&inverse)[3], const Lanes (&scaled)[3],
                        Lanes (&u)[3][8]) {
  Lanes g[3][8];
  Lanes e[6], s[6];
#pragma GCC unroll 3
  for (int i = 0; i < 3; ++i) {
    const int j = (i + 1) % 3, k = (i + 2) % 3;
    e[i] = u[i][1 << i] * inverse[i];
    e[3 + i] = u[j][1 << k] * inverse[k] + u[k][1 << j] * inverse[j];
  }
#pragma GCC unroll 6
  for (int r = 0; r < 6; ++r) {
    s[r] = c.constant[r][0] * e[0];
#pragma GCC unroll 5
    for (int q = 1; q < 6; ++q) s[r] += c.constant[r][q] * e[q];
  }
#pragma GCC unroll 3
  for (int i = 0; i < 3; ++i) {
    const int j = (i + 1) % 3, k = (i + 2) % 3;
    g[i][1 << i] = s[i] * scaled[i];
    g[i][1 << j] = s[3 + k] * scaled[j];
    g[i][1 << k] = s[3 + j] * scaled[k];
  }

  // fields x_i
  Lanes t[3][3];
#pragma GCC unroll 3
  for (int i = 0; i < 3; ++i) {
    const int j = (i + 1) % 3, k = (i + 2) % 3, ij = 1 << i | 1 << j, ik = 1 << i | 1 << k;
    const Lanes jj = u[j][ij] * inverse[j];
    const Lanes kk = u[k][ik] * inverse[k];
    const Lanes jk = u[j][ik] * inverse[k] + u[k][ij] * inverse[j];
    const auto& m = c.linear[i];
#pragma GCC unroll 3
    for (int r = 0; r < 3; ++r) t[i][r] = m[r][0] * jj + m[r][1] * kk + m[r][2] * jk;
  }
#pragma GCC unroll 3
  for (int i = 0; i < 3; ++i) {
    const int j = (i + 1) % 3, k = (i + 2) % 3;
    g[j][1 << i | 1 << j] = t[i][0] * scaled[j];
    g[k][1 << i | 1 << k] = t[i][1] * scaled[k];
    g[i][1 << j | 1 << k] = t[j][2] * scaled[k] + t[k][2] * scaled[j];
  }

  // fields x_j x_k
  Lanes trilinear[3] = {};
#pragma GCC unroll 3
  for (int i = 0; i < 3; ++i) {
    const int j = (i + 1) % 3, k = (i + 2) % 3;
    const Lanes squared = inverse[i] * scaled[i];
    const auto& m = c.bilinear[i];
    const Lanes p[3] = {u[i][7] * squared, u[j][7] * squared, u[k][7] * squared};
    trilinear[i] += m[0][0] * p[0] + m[0][1] * p[1] + m[0][2] * p[2];
    trilinear[j] += m[1][0] * p[0] + m[1][1] * p[1] + m[1][2] * p[2];
    trilinear[k] += m[2][0] * p[0] + m[2][1] * p[1] + m[2][2] * p[2];
  }
#pragma GCC unroll 3
  for (int i = 0; i < 3; ++i) {
    g[i][0] = Lanes{};
    g[i][7] = trilinear[i];
#pragma GCC unroll 8
    for (int mode = 0; mode < 8; ++mode) u[i][mode] = g[i][mode];
  }
}

/// Displacements of the batch's nodes as modal coefficients.
inline void gather_modes(const std::int32_t (&node)[8][lane_count], const Vec* displacement, Lanes (&u)[3][8]) {
#pragma GCC unroll 8
  for (int corner = 0; corner < 8; ++corner)
    gather(displacement, node[corner], u[0][corner], u[1][corner], u[2][corner]);
#pragma GCC unroll 3
  for (int axis = 0; axis < 3; ++axis) to_modes(u[axis]);
}

/// force -= K u for the nodes in own. Never inlined: the same code for every thread count, so that the bits agree.
/// Leaving out the zeros of an isotropic stiffness gains nothing: gathering and scattering take the time.
[[gnu::noinline]] inline void subtract_brick_forces(const BrickBatch& batch, const BrickStiffness& stiffness,
                                                    const Vec* displacement, NodeRange own, bool whole, Vec* force) {
  Lanes u[3][8];
  gather_modes(batch.node, displacement, u);
  const Lanes inverse[3] = {batch.inverse[0], batch.inverse[1], batch.inverse[2]};
  const Lanes scaled[3] = {inverse[0] * batch.scale, inverse[1] * batch.scale, inverse[2] * batch.scale};
  brick_modes(stiffness, inverse, scaled, u);
#pragma GCC unroll 3
  for (int axis = 0; axis < 3; ++axis) to_nodes(u[axis]);
#pragma GCC unroll 8
  for (int corner = 0; corner < 8; ++corner)
    scatter_minus(u[0][corner], u[1][corner], u[2][corner], batch.node[corner], own, whole, force);
}

/// Elastic energy of the batch, J.
[[gnu::noinline]] inline double brick_energy(const BrickBatch& batch, const BrickStiffness& stiffness,
                                             const Vec* displacement) {
  Lanes u[3][8], g[3][8];
  gather_modes(batch.node, displacement, u);
  const Lanes inverse[3] = {batch.inverse[0], batch.inverse[1], batch.inverse[2]};
  const Lanes scaled[3] = {inverse[0] * batch.scale, inverse[1] * batch.scale, inverse[2] * batch.scale};
  for (int axis = 0; axis < 3; ++axis)
    for (int mode = 0; mode < 8; ++mode) g[axis][mode] = u[axis][mode];
  brick_modes(stiffness, inverse, scaled, g);
  Lanes twice{};
  for (int axis = 0; axis < 3; ++axis)
    for (int mode = 1; mode < 8; ++mode) twice += u[axis][mode] * g[axis][mode];
  return 0.5 * sum(twice);
}

}  // namespace gabion::continuum
