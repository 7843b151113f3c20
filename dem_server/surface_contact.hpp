#pragma once
// A grain against a rigid surface: a wall or a face of the block. The contact has the stiffness of two
// such grains in series, no bond, and Coulomb friction; rolling resistance and dashpots (dissipation.hpp) as well as of
// two such grains, the dashpots with the reduced mass of grain and surface.
//
//   e = distance of the centre - r,  a = r + e/2         elongation, arm of the contact point [m]
//   ds = dt (v_surface - v - omega x a n)                slip in the last step, tangential part [m]
//   f = k_n e n + k_s s                                  force on the grain, n from grain to surface [N]
//
// The spring turns with the normal (the smallest rotation that takes the old one to the new one) and
// with the mean spin about it; slip is booked as in contact_loop.hpp.

#include "dem_server/dissipation.hpp"

namespace gabion::dem {

struct SurfaceContact {
  std::int32_t surface = 0;  ///< wall index; 0 for the block
  std::int32_t grain = 0;
  ContactSpring stiffness;  ///< weight included
  RollingResistance rolling;
  ContactDamper damper;
  Vec spring{};             ///< m
  Vec bending{};            ///< rolling spring, rad
  Vec drag{};               ///< of the dashpots in the last step: shear, N; fourth: normal, N
  Vec normal{};             ///< from grain to surface in the last step
  Vec force{};              ///< on the grain in the last step, N
  double elongation = 0.0;  ///< in the last step, m
  std::uint8_t state = open;

  double energy() const {
    if (!(state & touching)) return 0.0;
    return 0.5 * (stiffness.normal * elongation * elongation + stiffness.shear * dot(spring, spring) +
                  rolling.stiffness * dot(bending, bending));
  }
  /// On the grain in the last step, N m.
  Vec couple() const { return splat(rolling.stiffness) * bending; }
};

/// Where and how a grain meets the surface at t_n.
struct Meeting {
  double elongation;  ///< m
  Vec normal;         ///< from grain to surface
  Vec velocity;       ///< of the surface at the contact point, relative to the grain there, m/s
  double twist;       ///< mean spin about the normal, rad/s
  Vec spin;           ///< of the surface relative to the grain, rad/s
};

inline double contact_arm(double radius, double elongation) {
  return radius + 0.5 * elongation;
}

/// Takes a vector of the contact's plane along with the normal and the twist of the last step.
inline Vec turned_with_surface(const SurfaceContact& c, const Meeting& m, double past_step, Vec v) {
  const double cosine = dot(c.normal, m.normal);
  v -= splat(dot(v, m.normal) / (1.0 + cosine)) * (c.normal + m.normal);
  const Vec turn = splat(past_step * m.twist) * m.normal;
  return v + cross(turn, v + splat(0.5) * cross(turn, v));
}

/// The rolling spring and its loss in the last step, J, after the law; compression: N.
inline double roll_on_surface(SurfaceContact& c, const Meeting& m, double past_step, double compression) {
  const Vec before = c.state & touching ? turned_with_surface(c, m, past_step, c.bending) : Vec{};
  const Vec bent = before + splat(past_step) * m.spin, tried = bent - splat(dot(bent, m.normal)) * m.normal;
  c.bending = rolled(c.rolling, tried, compression);
  return 0.5 * c.rolling.stiffness * dot(before + c.bending, tried - c.bending);
}

/// Moves the springs along by the last step and applies the law; returns what was lost.
inline ContactLosses follow_surface(SurfaceContact& c, const Meeting& m, double past_step) {
  ContactLosses losses;
  if (!(c.state & touching) && !(m.elongation < 0.0)) {
    c.state = open;
    c.force = Vec{};
    c.elongation = m.elongation;
    c.normal = m.normal;
    return losses;
  }
  const Vec turned = c.state & touching ? turned_with_surface(c, m, past_step, c.spring) : c.spring;
  const Vec moved = turned + splat(past_step) * m.velocity;
  const Trial trial{m.elongation, moved - splat(dot(moved, m.normal)) * m.normal, false};
  Response r = coulomb(c.stiffness, trial);
  Vec drag{};
  if (c.damper.normal > 0.0) {
    Vec rate = m.velocity - splat(dot(m.velocity, m.normal)) * m.normal;
    rate[3] = dot(m.velocity, m.normal);
    if (r.state & touching) drag = damped(c.stiffness, c.damper, trial, rate, r);
    const double before_normal = c.drag[3];
    Vec before = c.drag, after = drag;
    before[3] = after[3] = 0.0;
    before = turned_with_surface(c, m, past_step, before);
    losses.damping = 0.5 * ((before_normal + drag[3]) * rate[3] * past_step + dot(before + after, trial.spring - turned));
    c.drag = drag;
  }
  if (r.state != touching)
    losses.friction = 0.5 * c.stiffness.shear * dot(turned + r.spring, trial.spring - r.spring);
  if ((c.state ^ r.state) & touching)
    losses.switching = switching_loss(c.stiffness.normal, c.elongation, m.elongation);
  const double tension = r.tension + drag[3];
  if (c.rolling.stiffness > 0.0) losses.rolling = roll_on_surface(c, m, past_step, -tension);
  c.spring = r.spring;
  c.state = r.state;
  c.normal = m.normal;
  c.elongation = m.elongation;
  drag[3] = 0.0;
  c.force = splat(tension) * m.normal + splat(c.stiffness.shear) * r.spring + drag;
  return losses;
}

/// k = w k_grain/2: two such grains in series.
inline ContactSpring surface_spring(const Grains& grains, std::size_t i, double friction, double weight) {
  const GrainMaterial& m = grains.material_of(i);
  const double r = grains.radius[i];
  return {0.5 * weight * m.normal_stiffness * r, 0.5 * weight * m.shear_stiffness * r, friction, 0.0};
}

/// Gives a new contact its springs and dashpots. mass: of the surface, kg, infinite for a wall.
inline void set_parameters(SurfaceContact& c, const Grains& grains, std::size_t i, double friction, double mass,
                           double weight) {
  const GrainMaterial& m = grains.material_of(i);
  const double r = grains.radius[i], reduced = 1.0 / (1.0 / grains.plain_mass(i) + 1.0 / mass);
  c.stiffness = surface_spring(grains, i, friction, weight);
  c.rolling = rolling_resistance(m, m, r, r, c.stiffness.shear);
  c.damper = contact_damper(m.damping_ratio, surface_spring(grains, i, friction, 1.0), reduced, weight);
}

}  // namespace gabion::dem
