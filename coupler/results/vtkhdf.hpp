#pragma once
// grains.vtkhdf and mesh.vtkhdf for readers of VTKHDF 2 with time steps (VTK 9.3, ParaView 5.12 and later). They
// hold no data: every array is a virtual dataset over those in results.h5, which must stay beside them.

#include <filesystem>
#include <string>
#include <vector>

#include "coupler/results/xdmf.hpp"

namespace gabion::coupler {

/// Writes one file for a grid whose geometry does not change. grids: the same grid at each state, all with the
/// same arrays; empty: nothing is written. Throws ResultsError.
void write_vtkhdf(const std::filesystem::path& path, const std::string& data, const std::vector<double>& times,
                  const std::vector<DrawnGrid>& grids);

}  // namespace gabion::coupler
