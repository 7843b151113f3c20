#pragma once
// The one loop over contacts of updated geometry; the law is a template parameter.
//
//   D = X_j - X_i + u_j - u_i,  d = |D|,  n = D/d                       branch [m]
//   e = (|D0|^2 - rest^2 + (D0 + D).du)/(d + rest)                      elongation without cancellation [m]
//   W = (a_i omega_i + a_j omega_j)/d                                   spin of the contact [rad/s]
//   ds = dt (dv - W x D_mid), tangential part                           slip in the last step [m]
//   t = dt (D_mid x dv/d^2 + n (omega_i + omega_j).n/2)                 turn of the contact plane [rad]
//   s = P (s + t x (s + t x s/2) + ds),  P = 1 - n n^T                  shear spring [m]
//   f = k_n e n + k_s s,  T_i = a_i n x f,  T_j = a_j n x f             after the law [N, N m]
//
// Increments use the branch in the middle of the step, D_mid = D - dv dt/2, so that a rigid rotation
// shears nothing. Losses are booked so that they close the leapfrog balance, in which a force works by
// the mean of its values at both ends of a step:
//   friction   1/2 k_s (s_old + s_new).(s_trial - s_new)
//   switching  see switching_loss, contacts that open or close in the step
//   breakage   the same, and 1/2 (f_old + f_new)(e_new - e_old) - change of 1/2 k_n e^2
// Rolling resistance and contact damping: see dissipation.hpp. Loops without them are their own instances, in which
// nothing of them is left.

#include "dem_server/contact_forces.hpp"
#include "dem_server/stretched_law.hpp"
#include "dem_server/vector_kernels.hpp"

namespace gabion::dem {

/// Arrays of one call, by pointer: the compiler then need not reload them.
struct LoopArrays {
  const std::int32_t *start, *second;
  Vec* branch;
  Vec* spring;
  const ContactSpring* stiffness;
  const BondStrength* strength;
  std::uint8_t* state;
  const Vec *displacement, *velocity, *spin;
  Vec *force, *torque;            // scatter
  Vec *pair_force, *pair_moment;  // keep
  const double* radius;
  double past_step;
  // only with rolling resistance, and with contact damping
  Vec *bending, *pair_couple;
  const RollingResistance* rolling;
  Vec* drag;
  const ContactDamper* damper;
  // read for a Stretched law only: of the ground in the last step; arms of the grains in their clumps, or null
  Vec strain_rate;
  const Vec* lever;
};

/// What one contact does to its grains. couple: on i, N m.
struct ContactAction {
  Vec force, moment;
  double arm_i, arm_j;
  Vec couple;
};

/// Which mechanisms a loop knows.
template <bool rotating_, bool rolling_, bool damped_>
struct LoopParts {
  static constexpr bool rotating = rotating_, rolling = rotating_ && rolling_, damped = damped_;
};

/// A broken bond that came fully apart is an ordinary pair again; neither rule gives a force here.
inline void forget_bond_length(const LoopArrays& a, std::size_t i, std::size_t c, double distance) {
  const double apart = a.radius[i] + a.radius[a.second[c]];
  if (distance <= apart) return;
  a.spring[c][3] = square_difference(norm(a.branch[c]), apart);
  a.branch[c][3] = apart;
  a.state[c] &= static_cast<std::uint8_t>(~offset);
}

/// A vector that turns by a small angle.
inline Vec turned_by(Vec angle, Vec v) {
  return v + cross_of(angle, fma(splat(0.5), cross_of(angle, v), v));
}

template <class Law, class Parts>
inline bool contact_action(const LoopArrays& a, std::size_t i, std::size_t c, ContactAction& action,
                           ContactSums& sums) {
  const auto j = static_cast<std::size_t>(a.second[c]);
  const std::uint8_t was = a.state[c];
  const Vec stored_branch = a.branch[c], stored_spring = a.spring[c];
  const Vec du = a.displacement[j] - a.displacement[i];
  const Vec rest_branch = without_fourth(stored_branch);
  const double rest = stored_branch[3], rest_square = stored_spring[3];
  const Vec D = rest_branch + du;
  const double stretch = rest_square + dot(rest_branch + D, du);  // d^2 - rest^2
  if (!(was & (bonded | touching)) && stretch >= 0.0) {
    if (was & offset) [[unlikely]]
      forget_bond_length(a, i, c, norm(D));
    return false;
  }
  const double d = std::sqrt(dot(D, D)), inverse = 1.0 / d;
  const Vec n = D * splat(inverse);
  const ContactSpring k = a.stiffness[c];

  // kinematics of the last step
  const Vec carried = carried_branch<Law>(a.lever, i, j, D);
  const Vec dv = relative_velocity<Law>(a.velocity[j] - a.velocity[i], a.strain_rate, carried);
  const Vec dt = splat(a.past_step);
  const Vec middle = fnma(splat(0.5 * a.past_step), dv, D);
  Vec slip = dv;
  Vec turn = cross_of(middle, dv) * splat(inverse * inverse);
  if constexpr (Parts::rotating) {
    const Vec mean = splat(0.5) * (a.spin[i] + a.spin[j]);
    slip -= cross_of(fma(splat(k.half_difference * inverse), a.spin[i] - a.spin[j], mean), middle);
    turn = fma(n, dot_all(mean, n), turn);
  }
  const Vec s0 = without_fourth(stored_spring);
  turn *= dt;
  const Vec turned = s0 + cross_of(turn, fma(splat(0.5), cross_of(turn, s0), s0));
  const Vec moved = fma(dt, slip, turned);

  const Trial trial{stretch / (d + rest), fnma(n, dot_all(moved, n), moved), (was & bonded) != 0};
  const BondStrength strength = Law::breakable ? a.strength[c] : BondStrength{};
  Response r = Law::respond(k, strength, trial);
  Vec drag{};
  if constexpr (Parts::damped) {
    Vec rate = fnma(n, dot_all(slip, n), slip);
    rate[3] = dot_all(dv, middle)[0] * inverse;
    if (r.state & touching) drag = damped(k, a.damper[c], trial, rate, r);
    Vec before = a.drag[c];
    const double before_normal = before[3];
    before = turned_by(turn, without_fourth(before));
    sums.losses.damping += 0.5 * ((before_normal + drag[3]) * rate[3] * a.past_step +
                                  dot_all(before + without_fourth(drag), trial.spring - turned)[0]);
    a.drag[c] = drag;
  }

  std::uint8_t now = r.state | (was & (broken | offset | counted));
  if ((was & bonded) && !(r.state & bonded)) [[unlikely]] {
    const Vec old_du = du - dt * dv, old_D = rest_branch + old_du;
    const double e_old = (rest_square + dot(rest_branch + old_D, old_du)) / (norm(old_D) + rest);
    const double f_old = k.normal * e_old, e = trial.elongation;
    const double stored = r.state & touching ? 0.5 * k.normal * e * e : 0.0;
    sums.losses.broken += 0.5 * (f_old + r.tension) * (e - e_old) - (stored - 0.5 * f_old * e_old) +
                          0.5 * k.shear * dot(turned + r.spring, trial.spring - r.spring);
    ++sums.breaks;
    now |= broken | offset;
  } else if (((was ^ r.state) & touching) && !(was & bonded)) [[unlikely]] {
    const Vec old_du = du - dt * dv, old_D = rest_branch + old_du;
    const double e_old = (rest_square + dot(rest_branch + old_D, old_du)) / (norm(old_D) + rest);
    sums.losses.switching += switching_loss(k.normal, e_old, trial.elongation);
    sums.losses.friction += 0.5 * k.shear * dot(turned + r.spring, trial.spring - r.spring);
  } else if (r.state != bonded && r.state != touching) {
    sums.losses.friction += 0.5 * k.shear * dot(turned + r.spring, trial.spring - r.spring);
  }
  if (now != was) a.state[c] = now;
  Vec store = r.spring;
  store[3] = rest_square;
  a.spring[c] = store;

  Vec shear_force = splat(k.shear) * r.spring;
  double tension = r.tension;
  if constexpr (Parts::damped) {
    shear_force += without_fourth(drag);
    tension += drag[3];
  }
  if constexpr (Parts::rolling) {
    const RollingResistance resistance = a.rolling[c];
    const Vec before = turned_by(turn, a.bending[c]);
    const Vec bent = fma(dt, a.spin[j] - a.spin[i], before), tried = fnma(n, dot_all(bent, n), bent);
    const Vec now_bent = r.state & touching ? rolled(resistance, tried, -tension) : Vec{};
    sums.losses.rolling += 0.5 * resistance.stiffness * dot(before + now_bent, tried - now_bent);
    a.bending[c] = now_bent;
    action.couple = splat(resistance.stiffness) * now_bent;
  }
  action.force = fma(splat(tension), n, shear_force);
  if constexpr (Parts::rotating) {
    action.moment = splat(k.shear) * cross_of(n, r.spring);
    if constexpr (Parts::damped) action.moment += cross_of(n, without_fourth(drag));
    action.arm_i = 0.5 * d + k.half_difference;
    action.arm_j = 0.5 * d - k.half_difference;
  }
  if constexpr (is_stretched<Law>) sums.virial += action.force * carried;
  return true;
}

/// One thread: forces go straight to the grains, in contact order.
template <class Law, class Parts>
void scatter_contacts(const LoopArrays& arrays, std::size_t first, std::size_t last, ContactSums& total) {
  // copies that nothing else points to: a store to an array need not be feared to change them
  const LoopArrays a = arrays;
  constexpr bool rotating = Parts::rotating;
  ContactSums sums;
  ContactAction act{};
  for (std::size_t i = first; i < last; ++i) {
    Vec fi = a.force[i], ti = rotating ? a.torque[i] : Vec{};
    for (std::int32_t c = a.start[i]; c < a.start[i + 1]; ++c) {
      if (!contact_action<Law, Parts>(a, i, c, act, sums)) continue;
      const auto j = static_cast<std::size_t>(a.second[c]);
      fi += act.force;
      if constexpr (rotating) ti = fma(splat(act.arm_i), act.moment, ti);
      if constexpr (Parts::rolling) ti += act.couple;
      if (j == i) [[unlikely]] {
        fi -= act.force;
        if constexpr (rotating) ti = fma(splat(act.arm_j), act.moment, ti);
        if constexpr (Parts::rolling) ti -= act.couple;
        continue;
      }
      a.force[j] -= act.force;
      if constexpr (rotating) a.torque[j] = fma(splat(act.arm_j), act.moment, a.torque[j]);
      if constexpr (Parts::rolling) a.torque[j] -= act.couple;
    }
    a.force[i] = fi;
    if constexpr (rotating) a.torque[i] = ti;
  }
  total = sums;
}

/// Several threads: forces are kept per contact, see PairBuffer.
template <class Law, class Parts>
void keep_contacts(const LoopArrays& arrays, std::size_t first, std::size_t last, ContactSums& total) {
  const LoopArrays a = arrays;
  ContactSums sums;
  ContactAction act{};
  for (std::size_t i = first; i < last; ++i)
    for (std::int32_t c = a.start[i]; c < a.start[i + 1]; ++c) {
      if (!contact_action<Law, Parts>(a, i, c, act, sums)) act = ContactAction{};
      act.force[3] = act.arm_i;
      a.pair_force[c] = act.force;
      if constexpr (Parts::rotating) {
        act.moment[3] = act.arm_j;
        a.pair_moment[c] = act.moment;
      }
      if constexpr (Parts::rolling) a.pair_couple[c] = act.couple;
    }
  total = sums;
}

}  // namespace gabion::dem
