#include "continuum_server/rates.hpp"

#include <algorithm>
#include <bit>
#include <string>

#include "protocol/engine/engine.hpp"

namespace gabion::continuum {

namespace {

using engine::RequestError;

/// Smallest and largest tier of each node's elements.
struct NodeTiers {
  std::vector<std::uint8_t> finest, coarsest;
};

NodeTiers node_tiers(const Mesh& mesh, const std::vector<std::uint8_t>& tier_of_element) {
  NodeTiers tiers{std::vector<std::uint8_t>(mesh.nodes.size(), 255), std::vector<std::uint8_t>(mesh.nodes.size(), 0)};
  for (std::size_t e = 0; e < mesh.elements.size(); ++e)
    for (const std::int32_t n : mesh.elements[e]) {
      tiers.finest[n] = std::min(tiers.finest[n], tier_of_element[e]);
      tiers.coarsest[n] = std::max(tiers.coarsest[n], tier_of_element[e]);
    }
  return tiers;
}

void check_rates(const Mesh& mesh, std::span<const std::uint8_t> rate) {
  if (rate.size() != mesh.elements.size())
    throw RequestError("RATES.rate", std::to_string(rate.size()) + " rates for " + std::to_string(mesh.elements.size()) + " elements",
                       "send one an element, or none");
  for (std::size_t e = 0; e < rate.size(); ++e)
    if (!std::has_single_bit(rate[e]))
      throw RequestError("RATES.rate", "element " + std::to_string(e) + " has the rate " + std::to_string(rate[e]), "send powers of two");
}

void check_order(const NodeTiers& tiers) {
  for (std::size_t n = 1; n < tiers.finest.size(); ++n) {
    const auto key = [&](std::size_t node) { return std::pair(tiers.finest[node], tiers.coarsest[node]); };
    if (key(n) < key(n - 1))
      throw RequestError("RATES.rate", "node " + std::to_string(n) + " has elements of smaller rates than node " + std::to_string(n - 1),
                         "number the nodes of MESH by the smallest and then by the largest rate of their elements");
  }
}

}  // namespace

Rates one_rate(std::size_t nodes) {
  Rates rates;
  rates.nodes = {{0, static_cast<std::int32_t>(nodes)}};
  return rates;
}

Rates make_rates(const Mesh& mesh, std::span<const std::uint8_t> rate) {
  if (rate.empty()) return one_rate(mesh.nodes.size());
  check_rates(mesh, rate);
  Rates rates;
  rates.rate.assign(rate.begin(), rate.end());
  std::sort(rates.rate.begin(), rates.rate.end());
  rates.rate.erase(std::unique(rates.rate.begin(), rates.rate.end()), rates.rate.end());
  if (!rates.several()) return one_rate(mesh.nodes.size());
  static_assert(engine::Work::most_tiers == 8, "a rate is a byte: 1 to 128");
  for (const std::uint8_t r : rate)
    rates.tier_of_element.push_back(static_cast<std::uint8_t>(std::lower_bound(rates.rate.begin(), rates.rate.end(), r) - rates.rate.begin()));

  const NodeTiers tiers = node_tiers(mesh, rates.tier_of_element);
  check_order(tiers);
  const auto first_with = [&](std::size_t finest, std::size_t coarsest) {
    std::int32_t n = 0;
    while (n < static_cast<std::int32_t>(tiers.finest.size()) && std::pair<std::size_t, std::size_t>(tiers.finest[n], tiers.coarsest[n]) < std::pair(finest, coarsest)) ++n;
    return n;
  };
  for (std::size_t t = 0; t < rates.tiers(); ++t) rates.nodes.push_back({first_with(t, 0), first_with(t + 1, 0)});
  rates.raised.assign(rates.tiers(), {});
  for (std::size_t t = 1; t < rates.tiers(); ++t)
    for (std::size_t finer = 0; finer < t; ++finer) {
      const NodeRange range{first_with(finer, t), rates.nodes[finer].last};
      if (range.first < range.last) rates.raised[t].push_back(range);
    }
  return rates;
}

void check_margin(const Rates& rates, const Mesh& mesh, std::size_t reach) {
  if (!rates.several() || reach == 0) return;
  const NodeTiers tiers = node_tiers(mesh, rates.tier_of_element);
  for (std::size_t e = 0; e < mesh.elements.size(); ++e) {
    const auto& nodes = mesh.elements[e];
    const auto tied = [&](std::int32_t n) { return static_cast<std::size_t>(n) < reach; };
    if (std::none_of(nodes.begin(), nodes.end(), tied)) continue;
    const bool fine = std::all_of(nodes.begin(), nodes.end(), [&](std::int32_t n) { return tiers.coarsest[n] == 0; });
    if (!fine || rates.rate.front() != 1)
      throw RequestError("RATES.rate", "element " + std::to_string(e) + " is tied, and it or one beside it has a rate above 1",
                         "give the elements that touch tied nodes, and one layer more, the rate 1: nearer changes of rate resonate");
  }
}

}  // namespace gabion::continuum
