#pragma once
// Where a held flat face of a packing is for the ground inside.
//
// Grains at a face are held at their centres, some way inside the face, and the layer there is packed otherwise than the
// inside. A continuum that is held on the face itself is therefore too long or too short:
//
//   u(x) = u_face + eps (x - x_face - s delta)       far from the face, under a uniaxial strain along its normal
//
//   u      displacement along the normal, m          eps    mean strain in the window
//   x      place along the normal, m                 s      +1 at a low face, -1 at a high one
//   delta  offset, m: how far inside the face the continuum would have to be held; below 0: outside
//
// the slip length of a rough wall turned round (for flow: Basset 1888; Jaeger & Mikelic 2001).

#include <span>

#include "dem_server/packing/homogenise.hpp"

namespace gabion::dem {

struct HeldFace {
  int axis = 2;
  bool high = false;
  double place = 0.0;                    ///< of the face along the axis, m
  std::vector<std::int32_t> grains;      ///< held there
  std::uint8_t components = 4;           ///< bits x = 1, y = 2, z = 4; holds the face's normal
};

struct FaceOffset {
  double offset = 0.0;    ///< delta, m
  double residual = 0.0;  ///< relative residual of the equilibrium
  bool converged = true;
};

/// Holds the face's grains as said, at the face's own displacement, and the packing's other flat faces at the affine
/// one, and measures delta from the grains in the window. Throws engine::RequestError when the window holds too few
/// grains, or the face holds none or not its normal.
FaceOffset face_offset(const BondNetwork& network, const Domain& domain, const HeldFace& face, const Window& window,
                       const HomogeniseOptions& options);

}  // namespace gabion::dem
