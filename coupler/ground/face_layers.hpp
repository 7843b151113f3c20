#pragma once
// The elements along a held face, stiffened or softened so that the mesh, which is held on the face, is as long as the
// grains, which are held at their centres.
//
//   C' = C T/(T - delta)     a layer T thick then gives way as T - delta of the ground does
//
//   C      stiffness of the ground, Pa              C'  of the layer, Pa
//   delta  offset of the face, m (MEASURE_FACE)     T   thickness of the layer, whole elements, m

#include <array>
#include <cstdint>
#include <vector>

#include "coupler/ground/mesh.hpp"

namespace gabion::coupler {

struct FaceLayers {
  std::vector<double> factor{1.0};    ///< on the stiffness, of each material of the mesh; the first is the ground itself
  std::vector<std::int32_t> material;  ///< of each element
};

/// offset: of the faces xmin, xmax, ymin, ymax, zmin, zmax, m; 0 where a face is to be left as it is. A layer is as many
/// elements thick as make it at least four offsets. An element of two layers takes both factors.
FaceLayers face_layers(const HexMesh& mesh, const std::array<double, 6>& offset);

}  // namespace gabion::coupler
