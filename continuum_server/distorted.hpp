#pragma once
// Hexahedra of any shape: nodal forces of eight elements at once, f = K u, K the condensed stiffness of
// hexahedron.hpp in the basis of hadamard.hpp without the means: 21 x 21 symmetric, 231 numbers an element.
// Reading them from memory is what the kernel's time goes into.

#include <array>
#include <cstddef>

#include "continuum_server/brick.hpp"
#include "continuum_server/hexahedron.hpp"

namespace gabion::continuum {

constexpr int modal_size = 21;                                  ///< 3 axes, 7 modes: 7 axis + mode - 1
constexpr int packed_size = modal_size * (modal_size + 1) / 2;  ///< upper triangle, row by row

/// Eight elements. Lanes beyond the last one repeat lane 0 with zero stiffness.
struct DistortedBatch {
  std::int32_t node[8][lane_count];  ///< by bits of the corner, see hadamard.hpp
  Lanes stiffness[packed_size];      ///< N/m, with the weight
};

/// 1/64 H K H^T of a 24 x 24 element stiffness.
inline std::array<double, packed_size> packed_modal(const ElementStiffness& k) {
  double half[24][modal_size];  // K H^T
  for (int row = 0; row < 24; ++row)
    for (int m = 0; m < modal_size; ++m) {
      half[row][m] = 0.0;
      for (int corner = 0; corner < 8; ++corner)
        half[row][m] += k[24 * row + 3 * corner + m / 7] * mode_at(m % 7 + 1, corner);
    }
  std::array<double, packed_size> packed;
  int place = 0;
  for (int r = 0; r < modal_size; ++r)
    for (int s = r; s < modal_size; ++s) {
      double total = 0.0;
      for (int corner = 0; corner < 8; ++corner) total += mode_at(r % 7 + 1, corner) * half[3 * corner + r / 7][s];
      packed[place++] = total / 64.0;
    }
  return packed;
}

/// Modal forces g = K u of the batch.
inline void distorted_modes(const DistortedBatch& batch, const Lanes (&u)[3][8], Lanes (&g)[3][8]) {
  Lanes x[modal_size], y[modal_size] = {};
  for (int m = 0; m < modal_size; ++m) x[m] = u[m / 7][m % 7 + 1];
  const Lanes* k = batch.stiffness;
  for (int r = 0; r < modal_size; ++r) {
    const Lanes xr = x[r];
    Lanes yr = y[r] + *k++ * xr;
    for (int s = r + 1; s < modal_size; ++s, ++k) {
      yr += *k * x[s];
      y[s] += *k * xr;
    }
    y[r] = yr;
  }
  for (int axis = 0; axis < 3; ++axis) g[axis][0] = Lanes{};
  for (int m = 0; m < modal_size; ++m) g[m / 7][m % 7 + 1] = y[m];
}

/// force -= K u for the nodes in own.
[[gnu::noinline]] inline void subtract_distorted_forces(const DistortedBatch& batch, const Vec* displacement,
                                                        NodeRange own, bool whole, Vec* force) {
  Lanes u[3][8], g[3][8];
  gather_modes(batch.node, displacement, u);
  distorted_modes(batch, u, g);
  for (int axis = 0; axis < 3; ++axis) to_nodes(g[axis]);
  for (int corner = 0; corner < 8; ++corner)
    scatter_minus(g[0][corner], g[1][corner], g[2][corner], batch.node[corner], own, whole, force);
}

/// Elastic energy of the batch, J.
[[gnu::noinline]] inline double distorted_energy(const DistortedBatch& batch, const Vec* displacement) {
  Lanes u[3][8], g[3][8];
  gather_modes(batch.node, displacement, u);
  distorted_modes(batch, u, g);
  Lanes twice{};
  for (int axis = 0; axis < 3; ++axis)
    for (int mode = 1; mode < 8; ++mode) twice += u[axis][mode] * g[axis][mode];
  return 0.5 * sum(twice);
}

}  // namespace gabion::continuum
