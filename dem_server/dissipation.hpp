#pragma once
// Rolling resistance and contact damping: pure functions of one frictional contact, as the laws are. A bond has
// neither; the springs of a contact that was bonded start at zero.
//
// Rolling resistance with a plastic limit (Iwashita & Oda 1998 in the incremental form of Belheine et al.
// 2009 and Plassiard, Belheine & Donze 2009):
//
//   dtheta = P dt (omega_j - omega_i),  P = 1 - n n^T      bending of the contact in the last step [rad]
//   M = k_r theta                                          moment on i, -M on j [N m]
//   k_r = beta k_s r_i r_j                                 rolling stiffness [N m]
//   |M| <= eta min(r_i, r_j) N,  N >= 0                    the rest of theta is plastic rolling
//
// theta turns with the contact plane, as the shear spring does. Twist, the part along n, is free. With the smaller
// radius a grain rolls on a much larger one as it does on a plane.
//
// Contact damping, a dashpot beside each spring:
//
//   N = max(0, -(k_n e + c_n de/dt))                       no tension [N]
//   f_s = k_s s + lambda c_s ds/dt, |f_s| <= mu N          Coulomb's limit holds for the sum [N]
//   c = 2 gamma sqrt(k m*),  1/m* = 1/m_i + 1/m_j          gamma: see restitution.hpp [N s/m]
//
// The spring slides first; lambda in 0 to 1 is what friction leaves the dashpot, 0 while the spring slides.
// Loss of both in a step, by the mean of the forces at its ends (see contact_loop.hpp):
//   rolling          1/2 k_r (theta_old + theta_new).(theta_trial - theta_new)
//   contact damping  1/2 (d_old + d_new).(de, ds),  d the forces of the dashpots

#include <algorithm>
#include <cmath>

#include "dem_server/contact_laws.hpp"
#include "dem_server/grains.hpp"

namespace gabion::dem {

/// What contacts took out of the system since the start.
struct ContactLosses {
  double friction = 0.0;  ///< J
  double broken = 0.0;    ///< energy of bonds at breakage, J
  double rolling = 0.0;   ///< plastic rolling, J
  double damping = 0.0;   ///< dashpots of contacts, J
  double switching = 0.0;  ///< what a finite step takes, or gives where negative, at contacts that open or close, J

  void operator+=(const ContactLosses& other) {
    friction += other.friction;
    broken += other.broken;
    rolling += other.rolling;
    damping += other.damping;
    switching += other.switching;
  }
};

/// What a step takes in which a contact of stiffness k opens or closes between the elongations before and now, J: its
/// force works with the mean of its values at both ends, one of them 0, over the whole way; stored is 1/2 k e^2.
///   closing: -1/2 k e_before e_now >= 0    opening: 1/2 k e_before e_now <= 0
inline double switching_loss(double k, double before, double now) {
  return -0.5 * k * before * now * (now < before ? 1.0 : -1.0);
}

/// Rolling resistance of one contact, weight included in the stiffness.
struct RollingResistance {
  double stiffness = 0.0;  ///< k_r, N m; 0: none
  double arm = 0.0;        ///< eta min(r_i, r_j), m; may be infinite
};

/// Dashpots of one contact, weight included.
struct ContactDamper {
  double normal = 0.0;  ///< c_n, N s/m
  double shear = 0.0;   ///< c_s, N s/m
};

/// Whether grains of this material can resist rolling at all.
inline bool resists_rolling(const GrainMaterial& m) {
  return m.rolling_stiffness > 0.0 && m.rolling_friction > 0.0;
}

/// The smaller coefficients; shear: k_s of the contact, N/m.
inline RollingResistance rolling_resistance(const GrainMaterial& a, const GrainMaterial& b, double ri, double rj,
                                            double shear) {
  const double eta = std::min(a.rolling_friction, b.rolling_friction);
  if (!(eta > 0.0)) return {};
  return {std::min(a.rolling_stiffness, b.rolling_stiffness) * shear * ri * rj, eta * std::min(ri, rj)};
}

/// gamma: damping ratio; unweighted: stiffness without weight, N/m; mass: reduced, without weight, kg.
inline ContactDamper contact_damper(double gamma, const ContactSpring& unweighted, double mass, double weight) {
  return {2.0 * gamma * weight * std::sqrt(unweighted.normal * mass),
          2.0 * gamma * weight * std::sqrt(unweighted.shear * mass)};
}

/// Of two grains, with the smaller restitution.
inline ContactDamper pair_damper(const Grains& grains, std::size_t i, std::size_t j, double weight) {
  const double gamma = std::max(grains.material_of(i).damping_ratio, grains.material_of(j).damping_ratio);
  return contact_damper(gamma, contact_spring(grains, i, j, 1.0), in_series(grains.plain_mass(i), grains.plain_mass(j)),
                        weight);
}

/// Rolling spring after the limit, rad; compression: N, in N.
inline Vec rolled(const RollingResistance& k, Vec trial, double compression) {
  if (!(compression > 0.0)) return Vec{};
  const double limit = k.arm * compression;
  const double square = k.stiffness * k.stiffness * dot(trial, trial);
  return square <= limit * limit ? trial : splat(limit / std::sqrt(square)) * trial;
}

/// Forces of a contact's dashpots: shear, N; fourth: normal, N, positive in tension.
/// rate: slip velocity normal to n, m/s; fourth: rate of the elongation, m/s. response: what the law without dashpots
/// gave for trial, a contact in compression; becomes what it is with them, its tension still that of the spring alone.
inline Vec damped(const ContactSpring& k, const ContactDamper& c, const Trial& trial, Vec rate, Response& response) {
  const double tension = std::min(0.0, response.tension + c.normal * rate[3]);
  const double limit = tension < 0.0 ? -k.friction * tension : 0.0;
  const Vec held = splat(k.shear) * trial.spring;
  const double room = limit * limit - dot(held, held);
  Vec drag{};
  if (room < 0.0) {
    response.spring = splat(limit / norm(held)) * trial.spring;
    response.state = touching | sliding;
  } else {
    response.spring = trial.spring;
    response.state = touching;
    drag = splat(c.shear) * rate;
    drag[3] = 0.0;
    const double square = dot(drag, drag), along = dot(held, drag);
    if (square + 2.0 * along > room)  // lambda: |held + lambda drag| = limit
      drag *= splat((std::sqrt(along * along + square * room) - along) / square);
  }
  drag[3] = tension - response.tension;
  return drag;
}

}  // namespace gabion::dem
