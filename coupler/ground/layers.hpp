#pragma once
// Layers of elements around the interface, for elements that are evaluated less often the farther away they are.

#include <array>
#include <cstdint>
#include <vector>

#include "coupler/scene/scene.hpp"

namespace gabion::coupler {

/// Layers between each element and the nearest one of the interface, over shared nodes; 0 in the interface itself.
std::vector<int> layers_from(const std::vector<std::array<std::int64_t, 8>>& elements, std::size_t nodes,
                             const std::vector<bool>& interface_element);

/// Level of each element: 0 up to first_layers beyond the interface; then one more after each `layers` layers, the rate
/// being 2^level, or, not nested, 1 for all the rest.
std::vector<std::uint8_t> rate_levels(const scene::Rates& rates, const std::vector<int>& layer);

}  // namespace gabion::coupler
