#pragma once
// A grain against a rigid surface: a wall or a face of the block. The contact has the stiffness of two
// such grains in series, no bond, and Coulomb friction.
//
//   e = distance of the centre - r,  a = r + e/2         elongation, arm of the contact point [m]
//   ds = dt (v_surface - v - omega x a n)                slip in the last step, tangential part [m]
//   f = k_n e n + k_s s                                  force on the grain, n from grain to surface [N]
//
// The spring turns with the normal (the smallest rotation that takes the old one to the new one) and
// with the mean spin about it; slip is booked as in contact_loop.hpp.

#include "dem_server/contact_laws.hpp"

namespace gabion::dem {

struct SurfaceContact {
  std::int32_t surface = 0;  ///< wall index; 0 for the block
  std::int32_t grain = 0;
  ContactSpring stiffness;  ///< weight included
  Vec spring{};             ///< m
  Vec normal{};             ///< from grain to surface in the last step
  Vec force{};              ///< on the grain in the last step, N
  double elongation = 0.0;  ///< in the last step, m
  std::uint8_t state = open;

  double energy() const {
    if (!(state & touching)) return 0.0;
    return 0.5 * (stiffness.normal * elongation * elongation + stiffness.shear * dot(spring, spring));
  }
};

/// Where and how a grain meets the surface at t_n.
struct Meeting {
  double elongation;  ///< m
  Vec normal;         ///< from grain to surface
  Vec velocity;       ///< of the surface at the contact point, relative to the grain there, m/s
  double twist;       ///< mean spin about the normal, rad/s
};

inline double contact_arm(double radius, double elongation) {
  return radius + 0.5 * elongation;
}

/// Moves the spring along by the last step and applies the law; returns the friction work, J.
inline double follow_surface(SurfaceContact& c, const Meeting& m, double past_step) {
  if (!(c.state & touching) && !(m.elongation < 0.0)) {
    c.state = open;
    c.force = Vec{};
    c.elongation = m.elongation;
    c.normal = m.normal;
    return 0.0;
  }
  Vec turned = c.spring;
  if (c.state & touching) {
    const double cosine = dot(c.normal, m.normal);
    turned -= splat(dot(turned, m.normal) / (1.0 + cosine)) * (c.normal + m.normal);
    const Vec turn = splat(past_step * m.twist) * m.normal;
    turned += cross(turn, turned + splat(0.5) * cross(turn, turned));
  }
  const Vec moved = turned + splat(past_step) * m.velocity;
  const Trial trial{m.elongation, moved - splat(dot(moved, m.normal)) * m.normal, false};
  const Response r = coulomb(c.stiffness, trial);
  const double work =
      r.state == touching ? 0.0 : 0.5 * c.stiffness.shear * dot(turned + r.spring, trial.spring - r.spring);
  c.spring = r.spring;
  c.state = r.state;
  c.normal = m.normal;
  c.elongation = m.elongation;
  c.force = splat(r.tension) * m.normal + splat(c.stiffness.shear) * r.spring;
  return work;
}

/// k = w k_grain/2: two such grains in series.
inline ContactSpring surface_spring(const Grains& grains, std::size_t i, double friction, double weight) {
  const GrainMaterial& m = grains.material_of(i);
  const double r = grains.radius[i];
  return {0.5 * weight * m.normal_stiffness * r, 0.5 * weight * m.shear_stiffness * r, friction, 0.0};
}

}  // namespace gabion::dem
