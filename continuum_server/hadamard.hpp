#pragma once
// The eight nodal values of a hexahedron in the tensor-product basis of its natural coordinates
// xi, eta, zeta in [-1, 1]:
//
//   u(xi, eta, zeta) = 1/8 sum_m c_m phi_m,    c_m = sum_J phi_m(J) u_J,    phi_m = xi^b0 eta^b1 zeta^b2
//
// where b0, b1, b2 are the bits of m: 1 is xi, 2 eta, 4 zeta, 3 xi*eta, 5 xi*zeta, 6 eta*zeta, 7 all
// three; 0 the mean. (Flanagan & Belytschko 1981, in tensor form.)

namespace gabion::continuum {

/// Corner at xi, eta, zeta = -1 or +1, the bits of the index as above. The mesh's order goes round each layer.
constexpr int corner_at[8] = {0, 1, 3, 2, 4, 5, 7, 6};

/// Natural coordinate (-1 or 1) of a corner in the mesh's order.
constexpr double corner_sign(int corner, int axis) {
  return (corner_at[corner] >> axis) & 1 ? 1.0 : -1.0;
}

/// phi_m at a corner.
constexpr double mode_at(int mode, int corner) {
  double value = 1.0;
  for (int axis = 0; axis < 3; ++axis)
    if (mode >> axis & 1) value *= corner_sign(corner, axis);
  return value;
}

/// In place, values indexed by bits: nodal values to c_m.
template <class T>
inline void to_modes(T* v) {
#pragma GCC unroll 3
  for (int bit = 1; bit < 8; bit *= 2)
#pragma GCC unroll 8
    for (int low = 0; low < 8; ++low) {
      if (low & bit) continue;
      const T minus = v[low], plus = v[low | bit];
      v[low] = plus + minus;
      v[low | bit] = plus - minus;
    }
}

/// In place: g_m to nodal values f_J = sum_m phi_m(J) g_m, the transpose of to_modes.
template <class T>
inline void to_nodes(T* v) {
#pragma GCC unroll 3
  for (int bit = 4; bit > 0; bit /= 2)
#pragma GCC unroll 8
    for (int low = 0; low < 8; ++low) {
      if (low & bit) continue;
      const T even = v[low], odd = v[low | bit];
      v[low] = even - odd;
      v[low | bit] = even + odd;
    }
}

}  // namespace gabion::continuum
