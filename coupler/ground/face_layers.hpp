#pragma once
// The elements along a held face, stiffened or softened across it so that the mesh, which is held on the face, is as long
// as the grains, which are held at their centres. With n the components across the face (of z: zz, yz, zx), p the others:
//
//   sigma_n = A e_n + B e_p,   sigma_p = B^T e_n + D e_p     the ground
//   A' = A/s,  B' = B,  D' = D - (1 - s) B^T A^-1 B          the layer
//
// a laminate (Backus 1962) of the ground, s of the layer's thickness, and of something that does not give way across the
// face; along the face, under no stress across it, the layer is as stiff as the ground: D - B^T A^-1 B is the same.
//
//   s = (T - delta)/T     delta  offset of the face, m (MEASURE_FACE)     T  thickness of the layer, whole elements, m

#include <array>
#include <cstdint>
#include <vector>

#include "coupler/ground/elasticity.hpp"
#include "coupler/ground/mesh.hpp"

namespace gabion::coupler {

struct FaceLayers {
  std::vector<std::array<double, 3>> share{{1, 1, 1}};  ///< s along x, y, z of each material; the first is the ground itself
  std::vector<std::int32_t> material;                   ///< of each element
};

/// offset: of the faces xmin, xmax, ymin, ymax, zmin, zmax, m; 0 where a face is to be left as it is. A layer is as many
/// elements thick as make it at least four offsets; where those of opposite faces meet, both shares count.
FaceLayers face_layers(const HexMesh& mesh, const std::array<double, 6>& offset);

/// The stiffness of a layer, Pa; the axes with a share other than 1 one after the other.
Stiffness layer_stiffness(const Stiffness& ground, const std::array<double, 3>& share);

}  // namespace gabion::coupler
