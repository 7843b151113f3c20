#pragma once
// A displacement at a point, as a linear combination of the displacements of grains or nodes.

#include <cstdint>
#include <vector>

#include "coupler/ground/mesh.hpp"
#include "coupler/interface/rows.hpp"

namespace gabion::coupler {

struct ProbeRow {
  std::vector<std::int32_t> entities;
  std::vector<double> coefficients;
};

/// Least-squares affine fit over the grains within two mean diameters (more where there are too few),
/// evaluated at the point. Throws std::runtime_error when there are fewer than four grains in all.
ProbeRow probe_in_grains(const Point& at, const GrainSet& grains, const Box& ground,
                         const std::array<bool, 3>& periodic);

/// The element's shape functions.
ProbeRow probe_in_mesh(const Point& at, const HexMesh& mesh, const Zone& zone);

}  // namespace gabion::coupler
