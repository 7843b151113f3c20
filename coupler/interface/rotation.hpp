#pragma once
// How far the interface has turned.

#include <span>

#include "coupler/ground/mesh.hpp"
#include "coupler/interface/rows.hpp"

namespace gabion::coupler {

/// Angle, rad, of the least-squares infinitesimal rotation of the tied nodes. displacement: [nodes][3].
double interface_rotation(const HexMesh& mesh, const InterfaceRows& rows, std::span<const double> displacement);

}  // namespace gabion::coupler
