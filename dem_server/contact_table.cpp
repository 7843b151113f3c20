#include "dem_server/contact_table.hpp"

#include <algorithm>
#include <iterator>

namespace gabion::dem {
namespace {

/// Pairs with a larger gap at rest, over the sum of their radii, are no neighbours: they meet only when grains travel.
constexpr double neighbour_gap = 0.0125;

void reserve(ContactTable& table, const ContactSource& source, std::size_t pairs) {
  table.start.assign(source.grains.size() + 1, 0);
  table.second.reserve(pairs);
  table.image.reserve(pairs);
  table.branch.reserve(pairs);
  table.spring.reserve(pairs);
  table.stiffness.reserve(pairs);
  table.state.reserve(pairs);
  if (source.breakable) table.strength.reserve(pairs);
  if (source.rolling) {
    table.bending.reserve(pairs);
    table.rolling.reserve(pairs);
  }
  if (source.damped) {
    table.drag.reserve(pairs);
    table.damper.reserve(pairs);
  }
}

void append_new(ContactTable& table, const ContactSource& source, const Pair& pair, bool bond) {
  const auto i = static_cast<std::size_t>(pair.i), j = static_cast<std::size_t>(pair.j);
  Vec branch = source.rest[j] - source.rest[i] + source.domain.offset(pair.image);
  const double weight = contact_weight(source, i, j, branch, bond);
  const double length = norm(branch);
  const double rest = bond ? length : source.grains.radius[i] + source.grains.radius[j];
  branch[3] = rest;
  Vec spring{};
  spring[3] = bond ? 0.0 : square_difference(length, rest);
  ++table.start[i + 1];
  table.second.push_back(pair.j);
  table.image.push_back(pair.image);
  table.branch.push_back(branch);
  table.spring.push_back(spring);
  table.stiffness.push_back(contact_spring(source.grains, i, j, weight));
  if (source.breakable) table.strength.push_back(bond_strength(source.grains, i, j, weight));
  table.state.push_back(bond ? bonded : open);
  const Grains& g = source.grains;
  if (source.rolling) {
    table.bending.push_back(Vec{});
    table.rolling.push_back(rolling_resistance(g.material_of(i), g.material_of(j), g.radius[i], g.radius[j],
                                               table.stiffness.back().shear));
  }
  if (source.damped) {
    table.drag.push_back(Vec{});
    table.damper.push_back(pair_damper(g, i, j, weight));
  }
}

void append_old(ContactTable& table, const ContactTable& old, std::size_t i, std::size_t c) {
  ++table.start[i + 1];
  table.second.push_back(old.second[c]);
  table.image.push_back(old.image[c]);
  table.branch.push_back(old.branch[c]);
  table.spring.push_back(old.spring[c]);
  table.stiffness.push_back(old.stiffness[c]);
  if (!old.strength.empty()) table.strength.push_back(old.strength[c]);
  table.state.push_back(old.state[c]);
  if (!old.bending.empty()) {
    table.bending.push_back(old.bending[c]);
    table.rolling.push_back(old.rolling[c]);
  }
  if (!old.drag.empty()) {
    table.drag.push_back(old.drag[c]);
    table.damper.push_back(old.damper[c]);
  }
}

void close(ContactTable& table) {
  for (std::size_t i = 0; i + 1 < table.start.size(); ++i) table.start[i + 1] += table.start[i];
}

}  // namespace

double contact_share(const Grains& grains, std::size_t i, std::size_t j, double distance) {
  const double ri = grains.radius[i], rj = grains.radius[j];
  // pairs that form late may be far apart at rest; then the radii alone decide
  if (distance > 2.0 * (ri + rj)) return ri / (ri + rj);
  return std::clamp(0.5 + 0.5 * (ri - rj) / distance, 0.0, 1.0);
}

double contact_weight(const ContactSource& source, std::size_t i, std::size_t j, Vec branch, bool bond) {
  const engine::WeightField& weights = source.weights;
  if (!weights.border() && weights.width <= 0.0) return 1.0;
  const double ri = source.grains.radius[i], rj = source.grains.radius[j];
  if (!bond && norm(branch) > (1.0 + neighbour_gap) * (ri + rj))
    return std::min(weights.of_grain(source.rest[i], ri), weights.of_grain(source.rest[i] + branch, rj));
  if (weights.border()) return weights.share_of_line(source.rest[i], branch);
  const double share = contact_share(source.grains, i, j, norm(branch));
  return source.weights.at(source.rest[i] + splat(share) * branch);
}

ContactTable first_table(const ContactSource& source, const std::vector<Pair>& bonds,
                         const std::vector<Pair>& candidates) {
  ContactTable table;
  reserve(table, source, bonds.size() + candidates.size());
  auto bond = bonds.begin();
  auto candidate = candidates.begin();
  while (bond != bonds.end() || candidate != candidates.end()) {
    const bool is_bond = candidate == candidates.end() || (bond != bonds.end() && *bond <= *candidate);
    if (!is_bond) {
      append_new(table, source, *candidate++, false);
      continue;
    }
    if (candidate != candidates.end() && *candidate == *bond) ++candidate;
    append_new(table, source, *bond++, true);
  }
  close(table);
  return table;
}

ContactTable renewed_table(const ContactSource& source, const ContactTable& old, const std::vector<Pair>& candidates) {
  ContactTable table;
  reserve(table, source, std::max(old.size(), candidates.size()));
  auto candidate = candidates.begin();
  old.each([&](std::size_t i, std::size_t c) {
    const Pair pair = old.pair(i, c);
    for (; candidate != candidates.end() && *candidate < pair; ++candidate)
      append_new(table, source, *candidate, false);
    const bool near = candidate != candidates.end() && *candidate == pair;
    if (near) ++candidate;
    if (near || (old.state[c] & (bonded | touching | offset))) append_old(table, old, i, c);
  });
  for (; candidate != candidates.end(); ++candidate) append_new(table, source, *candidate, false);
  close(table);
  return table;
}

}  // namespace gabion::dem
