#pragma once
// The contacts and near pairs of a packing, in the order (i, j, image). Contacts of grains with low
// indices come first, so those that touch the interface can be done before the rest.

#include <array>
#include <cstdint>
#include <vector>

#include "dem_server/contact_laws.hpp"
#include "dem_server/dissipation.hpp"
#include "dem_server/grains.hpp"
#include "protocol/engine/engine.hpp"

namespace gabion::dem {

struct ContactTable {
  std::vector<std::int32_t> start{0};             ///< pairs of grain i as the first one: [start[i], start[i+1])
  std::vector<std::int32_t> second;               ///< j, at least i
  std::vector<std::array<std::int8_t, 3>> image;  ///< of j, in periods
  VecField branch;                                ///< X_j + image - X_i, m; fourth: rest length, m
  VecField spring;                                ///< shear elongation, m; fourth: |branch|^2 - rest^2, m2
  std::vector<ContactSpring> stiffness;           ///< weight included
  std::vector<BondStrength> strength;             ///< weight included; empty when no bond can break
  std::vector<std::uint8_t> state;                ///< ContactState bits
  // empty unless some material resists rolling
  VecField bending;                        ///< rolling spring, rad
  std::vector<RollingResistance> rolling;  ///< weight included
  // empty unless some material has a restitution below 1
  VecField drag;                      ///< forces of the dashpots in the last step: shear, N; fourth: normal, N
  std::vector<ContactDamper> damper;  ///< weight included

  std::size_t size() const { return second.size(); }
  std::size_t grains() const { return start.size() - 1; }
  Pair pair(std::size_t i, std::size_t c) const { return {static_cast<std::int32_t>(i), second[c], image[c]}; }

  /// Calls visit(i, c) in order.
  template <typename Visit>
  void each(Visit&& visit) const {
    for (std::size_t i = 0; i < grains(); ++i)
      for (std::int32_t c = start[i]; c < start[i + 1]; ++c) visit(i, static_cast<std::size_t>(c));
  }
};

/// The fourth of spring for a pair that touches at the rest length.
inline double square_difference(double length, double rest) {
  return (length - rest) * (length + rest);
}

/// What a table is made from.
struct ContactSource {
  const Grains& grains;
  const VecField& rest;  ///< positions at rest, m
  const Domain& domain;
  const engine::WeightField& weights;
  bool breakable;  ///< some bond strength is finite
  bool rolling;    ///< some material resists rolling
  bool damped;     ///< some material has a restitution below 1
};

/// Share of the way from i to j at which grain i touches grain j at rest; outside the pair never.
double contact_share(const Grains& grains, std::size_t i, std::size_t j, double distance);

/// Weight at the contact point at rest for bonds and neighbours. Grains that are none at rest, such as one thrown out of the pure zone
/// that lands on the overlap, touch with the smaller of their two weights: more would be too stiff for the lighter one, whose
/// mass has its own weight, and unstable. branch: from i to j at rest, m.
double contact_weight(const ContactSource& source, std::size_t i, std::size_t j, Vec branch, bool bond);

/// Bonds, stress-free as they stand at rest, and candidates, free of force until they touch.
/// Both sorted.
ContactTable first_table(const ContactSource& source, const std::vector<Pair>& bonds,
                         const std::vector<Pair>& candidates);

/// A new list with the history of the old one: bonds and contacts that remember their bond's length
/// stay whatever their distance.
ContactTable renewed_table(const ContactSource& source, const ContactTable& old, const std::vector<Pair>& candidates);

/// Elongation of the normal spring of pair c for the relative displacement du = u_j - u_i, m:
/// e = (|D0|^2 - rest^2 + (2 D0 + du).du)/(d + rest), without cancellation for bonds; with the distance.
struct Reach {
  Vec branch;         ///< present D, m
  double distance;    ///< m
  double elongation;  ///< m
};
inline Reach reach_of(const ContactTable& table, std::size_t c, Vec du) {
  Vec rest_branch = table.branch[c];
  const double rest = rest_branch[3];
  rest_branch[3] = 0.0;
  const Vec now = rest_branch + du;
  const double distance = norm(now);
  return {now, distance, (table.spring[c][3] + dot(rest_branch + now, du)) / (distance + rest)};
}

}  // namespace gabion::dem
