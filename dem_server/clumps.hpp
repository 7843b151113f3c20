#pragma once
// Rigid clumps of spheres: bodies with six degrees of freedom whose members meet the rest of the world as spheres do.
//
//   V(n+1/2) = V(n-1/2) + dt F/M,       F = sum f_i                         [N]
//   L(n+1/2) = L(n-1/2) + dt T,         T = sum t_i + a_i x f_i,  a_i = R s_i   [N m]
//   omega = R' J^-1 R'^T L,             R' = exp(omega dt/2) R(n)           implicit midpoint, by iteration
//   u_c(n+1) = u_c(n) + dt V,           R(n+1) = exp(omega dt) R(n)
//   u_i = u_c + (R - 1) s_i,            v_i(n+1/2) = (u_i(n+1) - u_i(n))/dt = V + c omega x (a_i(n) + a_i(n+1))/2,
//                                       c = tan(omega dt/2)/(omega dt/2)
//
//   M, J   mass [kg] and inertia about the centre of mass in the frame at rest [kg m2], sums over the spheres (parallel
//          axes): where members overlap, the common part counts twice; packings overlap by 1e-6 of a radius
//   L      angular momentum about the centre of mass [kg m2/s]
//   s_i    place of a member from the centre of mass at rest [m]
//   f_i, t_i  force and torque on member i
//
// With L constant over the drift the midpoint rule is symmetric in time: a free clump's energy swings and does not
// drift, its angular momentum is kept to round-off. Members follow from R alone, so that no shape is lost.

#include <span>

#include "dem_server/block.hpp"
#include "dem_server/clump_grouping.hpp"
#include "dem_server/rotation.hpp"

namespace gabion::dem {

/// (R - 1) x without cancellation: 2 w q x x + 2 q x (q x x).
inline Vec turn_of(const Quaternion& q, Vec x) {
  const Vec axis = vec(q[1], q[2], q[3]), once = cross(axis, x);
  return splat(2.0) * (splat(q[0]) * once + cross(axis, once));
}

class Clumps {
 public:
  bool empty() const { return bodies.empty(); }
  std::size_t size() const { return bodies.size(); }

  void clear() { *this = Clumps{}; }
  /// Replaces the clumps. grains: how many there are.
  void set(ClumpGrouping grouping, std::size_t grains);
  /// Masses, inertias and places of members at rest; the first time after set, the bodies' state from the members'.
  void build(const Domain& domain, engine::Motion& motion, Rotation& rotation);

  /// Removes pairs of members of one clump.
  void drop_internal(std::vector<Pair>& pairs) const;
  /// First member that is held, damped, weighted or has an index below the limit; -1 for none.
  std::int32_t first_bound_member(const engine::Motion& motion, std::size_t limit) const;

  /// After the trial of the grains: V, L and omega at n+1/2 in bodies, velocity and spin of their members.
  void kick(const engine::StepContext& context, engine::Motion& motion, Rotation& rotation);
  /// After the drift of the grains: moves the bodies and puts members in their places.
  void drift(const engine::StepContext& context, engine::Motion& motion);

  /// Members' fields were set: the bodies' state becomes the nearest rigid one, and the members follow it.
  /// Mean displacement, and the rotation that fits the members' places best (least squares, weighted with mass).
  void take_displacement(engine::Motion& motion);
  /// The members' momentum and angular momentum.
  void take_velocity(engine::Motion& motion, Rotation& rotation);
  /// Their mean spin.
  void take_spin(engine::Motion& motion, Rotation& rotation);
  void take_angle(Rotation& rotation) const;
  /// A state was read: recomputes what follows from it.
  void state_changed();

  /// What the bodies have more than the sums over their members as single spheres have, as Motion and Rotation make
  /// them; both measures agree to (omega dt)^2. The energies in J need measured.
  double kinetic_difference(const engine::Motion& motion) const;
  double rotational_difference(const Rotation& rotation) const;
  Vec angular_momentum_difference(const engine::Motion& motion, const Rotation& rotation) const;
  /// Mean of |force| over bodies and single grains, from the mean over grains, N.
  double mean_unbalanced_force(const engine::Motion& motion) const;

  /// Body of each grain, -1 for single ones; empty without clumps.
  const std::vector<std::int32_t>& body_of() const { return body_of_; }
  std::span<const std::int32_t> members(std::size_t b) const {
    return {grain_.data() + start_[b], grain_.data() + start_[b + 1]};
  }
  /// Present arms of the members, a_i, m.
  Vec arm(std::size_t b, std::size_t k) const { return offset_[start_[b] + k] + turn_[start_[b] + k]; }
  double mass(std::size_t b) const { return mass_[b]; }
  /// Columns of R J^-1 R^T, 1/(kg m2).
  std::array<Vec, 3> inverse_inertia(std::size_t b) const;

  /// What a checkpoint has to keep.
  struct Body {
    Vec displacement{};                       ///< of the centre of mass, m
    Vec velocity{};                           ///< m/s
    Vec momentum{};                           ///< angular, kg m2/s
    Vec spin{};                               ///< of the half step that momentum belongs to, rad/s
    Quaternion attitude{1.0, 0.0, 0.0, 0.0};  ///< R, from rest
  };
  std::vector<Body> bodies;
  engine::Work damping_work;  ///< J
  /// Tells one grouping from another.
  std::uint64_t grouping_key() const;

 private:
  /// What only the present step needs.
  struct Step {
    Vec old_velocity{}, old_momentum{}, old_spin{}, damping_force{}, damping_torque{};
    Quaternion next{1.0, 0.0, 0.0, 0.0};
    double chord = 1.0;  ///< c
  };

  void kick_one(std::size_t b, const engine::StepContext& context, engine::Motion& motion, Rotation& rotation);
  Vec midpoint_spin(std::size_t b, double dt) const;
  void move_members(std::size_t b, engine::Motion& motion, Rotation& rotation);
  void put_members(std::size_t b, engine::Motion& motion) const;
  void turn_with(std::size_t b, Vec velocity, Vec spin, engine::Motion& motion, Rotation& rotation);

  std::vector<std::int32_t> start_{0}, grain_;
  std::vector<std::array<std::int8_t, 3>> image_;
  std::vector<std::int32_t> body_of_, place_of_;  ///< of each grain: its body, its place in grain_
  VecField offset_;                               ///< s_i, m
  VecField turn_, next_turn_;                     ///< (R - 1) s_i at t_n and t_(n+1), m
  std::vector<double> mass_;
  VecField centre_;                                    ///< of mass at rest, m
  std::vector<std::array<Vec, 3>> inertia_, inverse_;  ///< J and its inverse, by columns
  std::vector<Step> step_;
  bool fresh_ = true;
  int threads_ = 1;
};

}  // namespace gabion::dem
