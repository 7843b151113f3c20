#include "coupler/ground/layers.hpp"

#include <algorithm>

namespace gabion::coupler {

namespace {

/// 2^7: a rate is a byte on the wire.
constexpr int highest_level = 7;

}  // namespace

std::vector<int> layers_from(const std::vector<std::array<std::int64_t, 8>>& elements, std::size_t nodes,
                             const std::vector<bool>& interface_element) {
  constexpr int far = 1 << 30;
  std::vector<int> layer(elements.size(), far);
  std::vector<bool> reached(nodes, false);
  std::vector<std::size_t> rest;
  for (std::size_t e = 0; e < elements.size(); ++e) rest.push_back(e);
  for (int count = 0; !rest.empty(); ++count) {
    std::vector<std::size_t> now, later;
    for (const std::size_t e : rest) {
      const auto touches = [&](std::int64_t n) { return reached[static_cast<std::size_t>(n)]; };
      const bool here = count == 0 ? interface_element[e] : std::any_of(elements[e].begin(), elements[e].end(), touches);
      (here ? now : later).push_back(e);
    }
    if (now.empty()) break;  // a part that hangs together with nothing
    for (const std::size_t e : now) {
      layer[e] = count;
      for (const std::int64_t n : elements[e]) reached[static_cast<std::size_t>(n)] = true;
    }
    rest = std::move(later);
  }
  return layer;
}

std::vector<std::uint8_t> rate_levels(const scene::Rates& rates, const std::vector<int>& layer) {
  std::vector<std::uint8_t> levels;
  for (const int count : layer) {
    const int beyond = count - rates.first_layers;
    const int level = beyond <= 0 ? 0 : rates.nested ? 1 + (beyond - 1) / rates.layers : 1;
    levels.push_back(static_cast<std::uint8_t>(std::min(level, highest_level)));
  }
  return levels;
}

}  // namespace gabion::coupler
