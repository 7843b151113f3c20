#include "coupler/results/mesh_corners.hpp"

#include <map>
#include <string>
#include <utility>

#include "coupler/results/errors.hpp"

namespace gabion::coupler {

DrawnMesh drawn_mesh(std::span<const double> nodes, std::span<const std::int32_t> elements,
                     std::span<const std::uint8_t> wrap, const std::array<double, 3>& period) {
  constexpr std::size_t corners_per_element = 8;
  const std::size_t count = nodes.size() / 3;
  if (nodes.size() % 3 || elements.size() % corners_per_element || (!wrap.empty() && wrap.size() != elements.size()))
    throw ResultsError("mesh geometry: " + std::to_string(nodes.size()) + " coordinates, " +
                       std::to_string(elements.size()) + " corners and " + std::to_string(wrap.size()) +
                       " wrap bits do not belong together");
  DrawnMesh drawn;
  drawn.nodes.assign(nodes.begin(), nodes.end());
  drawn.source.resize(count);
  for (std::size_t k = 0; k < count; ++k) drawn.source[k] = static_cast<std::int64_t>(k);

  std::map<std::pair<std::int32_t, std::uint8_t>, std::int64_t> repeated;
  drawn.corners.reserve(elements.size());
  for (std::size_t k = 0; k < elements.size(); ++k) {
    const std::int32_t node = elements[k];
    if (node < 0 || static_cast<std::size_t>(node) >= count)
      throw ResultsError("mesh geometry: element " + std::to_string(k / corners_per_element) + " names node " +
                         std::to_string(node) + " of " + std::to_string(count));
    const std::uint8_t bits = wrap.empty() ? std::uint8_t{0} : wrap[k];
    if (bits == 0) {
      drawn.corners.push_back(node);
      continue;
    }
    const auto [place, created] = repeated.try_emplace({node, bits}, static_cast<std::int64_t>(drawn.source.size()));
    if (created) {
      for (std::size_t axis = 0; axis < 3; ++axis)
        drawn.nodes.push_back(nodes[3 * static_cast<std::size_t>(node) + axis] +
                              ((bits >> axis) & 1 ? period[axis] : 0.0));
      drawn.source.push_back(node);
    }
    drawn.corners.push_back(place->second);
  }
  return drawn;
}

std::vector<double> gather(std::span<const double> values, std::size_t components,
                           std::span<const std::int64_t> source) {
  std::vector<double> drawn;
  drawn.reserve(source.size() * components);
  for (const std::int64_t node : source) {
    const auto first = values.begin() + node * static_cast<std::int64_t>(components);
    drawn.insert(drawn.end(), first, first + static_cast<std::int64_t>(components));
  }
  return drawn;
}

}  // namespace gabion::coupler
