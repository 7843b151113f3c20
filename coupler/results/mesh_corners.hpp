#pragma once
// Elements that close a periodic mesh join its two ends. Drawn as they are they would span the whole
// ground; drawn_mesh gives them corners of their own, one period further.

#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace gabion::coupler {

struct DrawnMesh {
  std::vector<double> nodes;         ///< [drawn][3] m; the mesh's own nodes first, in their order
  std::vector<std::int64_t> corners; ///< [elements][8] into nodes
  std::vector<std::int64_t> source;  ///< [drawn] the mesh's node each drawn node repeats
};

/// nodes [n][3]; elements [m][8]; wrap [m][8], bits x=1 y=2 z=4 as in the MESH message, or empty when nothing
/// wraps; period in m, read only along axes that wrap. Throws ResultsError on sizes or indices out of range.
DrawnMesh drawn_mesh(std::span<const double> nodes, std::span<const std::int32_t> elements,
                     std::span<const std::uint8_t> wrap, const std::array<double, 3>& period);

/// Values of the mesh's nodes [n][components] repeated for the drawn nodes.
std::vector<double> gather(std::span<const double> values, std::size_t components,
                           std::span<const std::int64_t> source);

}  // namespace gabion::coupler
