#pragma once
// Contact laws: pure functions of one contact. No law knows of lists, loops or threads.
//
//   f = k_n e n + k_s s           force on grain i (and -f on j), N
//   e   elongation of the normal spring, m: distance minus rest length, negative when compressed
//   n   unit vector from i to j
//   s   elongation of the shear spring, m, normal to n
//
// Coulomb (Cundall & Strack 1979): no tension; k_s |s| <= mu k_n |e|, the rest of s is slip.
// Bond (contact bond of PFC): k_n e <= b_n and k_s |s| <= b_s, else it breaks for good.

#include <cmath>
#include <cstdint>

#include "dem_server/grains.hpp"

namespace gabion::dem {

enum ContactState : std::uint8_t {
  open = 0,
  bonded = 1,
  touching = 2,  ///< not bonded, in compression
  sliding = 4,   ///< at the friction limit in the last step
  broken = 8,    ///< was bonded once
  offset = 16,   ///< broken, and still measured from the length the bond was made at
  counted = 32,  ///< its breakage was counted
};

/// A contact after a step in which nothing slipped or broke.
struct Trial {
  double elongation;  ///< m
  Vec spring;         ///< shear elongation, m
  bool bonded;
};

struct Response {
  double tension;      ///< N, negative in compression
  Vec spring;          ///< shear elongation, m
  std::uint8_t state;  ///< bonded, touching, sliding or open
};

inline Response coulomb(const ContactSpring& k, const Trial& trial) {
  if (!(trial.elongation < 0.0)) return {0.0, Vec{}, open};
  const double tension = k.normal * trial.elongation;
  const double limit = -k.friction * tension;
  const double shear_squared = k.shear * k.shear * dot(trial.spring, trial.spring);
  if (shear_squared <= limit * limit) return {tension, trial.spring, touching};
  return {tension, splat(limit / std::sqrt(shear_squared)) * trial.spring,
          static_cast<std::uint8_t>(touching | sliding)};
}

/// Bonds that never break; contacts that form later are frictional.
struct ElasticBond {
  static constexpr bool breakable = false;
  static Response respond(const ContactSpring& k, const BondStrength&, const Trial& trial) {
    if (trial.bonded) return {k.normal * trial.elongation, trial.spring, bonded};
    return coulomb(k, trial);
  }
};

/// Bonds that break, then friction.
struct BreakableBond {
  static constexpr bool breakable = true;
  static Response respond(const ContactSpring& k, const BondStrength& strength, const Trial& trial) {
    if (trial.bonded) {
      const double tension = k.normal * trial.elongation;
      const double shear_squared = k.shear * k.shear * dot(trial.spring, trial.spring);
      if (tension <= strength.tensile && shear_squared <= strength.shear * strength.shear)
        return {tension, trial.spring, bonded};
    }
    return coulomb(k, trial);
  }
};

/// No bonds at all.
struct Friction {
  static constexpr bool breakable = false;
  static Response respond(const ContactSpring& k, const BondStrength&, const Trial& trial) { return coulomb(k, trial); }
};

}  // namespace gabion::dem
