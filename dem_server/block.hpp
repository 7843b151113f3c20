#pragma once
// The rigid block: a convex polyhedron with six degrees of freedom that meets the grains.
//
//   V(n+1/2) = V(n-1/2) + dt F/M,  L(n+1/2) = L(n-1/2) + dt T,  omega = R I^-1 R^T L
//   x(n+1) = x(n) + dt V,          q(n+1) = turn(dt omega(n+1/2)) q(n), omega with R of the half step
//
//   M, I  mass [kg], principal inertia [kg m2]     L  angular momentum about the centroid [kg m2/s]

#include <array>
#include <span>
#include <vector>

#include "dem_server/linear_network.hpp"
#include "dem_server/polyhedron.hpp"
#include "dem_server/rotation.hpp"
#include "dem_server/surface_contact.hpp"

namespace gabion::dem {

using Quaternion = std::array<double, 4>;  ///< w, x, y, z; unit

/// Rotated axes: columns of the matrix of q.
std::array<Vec, 3> axes_of(const Quaternion& q);
Quaternion turned(const Quaternion& q, Vec angle);

struct BlockSetup {
  std::vector<Vec> vertices;  ///< m, absolute
  std::vector<std::int32_t> face_ptr, face_vertices;
  double mass = 0.0;      ///< kg
  Vec velocity{};         ///< m/s
  Vec spin{};             ///< rad/s
  bool rotation = true;   ///< free to rotate
  double friction = 0.0;  ///< Coulomb coefficient against grains
};

class Block {
 public:
  /// Replaces the block. Throws std::invalid_argument.
  void set(const BlockSetup& setup);
  bool present() const { return mass_ > 0.0; }

  /// Lists the grains within margin; contacts keep their history.
  void find(const ContactSource& source, const VecField& displacement, double margin);
  /// Bound on how far a point of the block has moved since find, m.
  double largest_travel() const;

  /// Adds the contact forces at t_n to grains and block.
  void add_forces(const Grains& grains, const Domain& domain, double past_step, engine::Motion& motion,
                  Rotation& rotation, bool rotating);
  /// V(n+1/2), L(n+1/2), with local damping as on grains.
  void kick(const engine::StepContext& context, Vec gravity);
  void drift(const engine::StepContext& context);

  double kinetic_energy() const;     ///< translation, J
  double rotational_energy() const;  ///< J
  double elastic_energy() const;     ///< J
  /// As engine::Motion::momentum, for this body.
  std::vector<double> momentum() const;
  double gravity_energy(Vec gravity) const;  ///< -M g.(x - x0), J
  double power_before(Vec gravity) const;    ///< of contacts and gravity on the velocity before the kick, W

  /// Springs for the stable step of the grains, and what the block itself has, see Spectra:
  /// |g - b|^2 <= (1 + split)|g|^2 + (1 + 1/split)|b|^2 decouples the two on the safe side.
  Spectra add_springs(const Grains& grains, double near, std::vector<SurfaceSpring>& springs) const;

  /// position 3, velocity 3, quaternion 4, spin 3, force 3, torque 3, then the corners 3 each.
  std::vector<double> state() const;
  /// Contact force of each of the last steps, oldest first, at most remembered_forces of them, N.
  VecField recent_forces() const;
  static constexpr std::size_t remembered_forces = 64;
  std::vector<SurfaceContact> contacts;  ///< sorted by grain
  ContactLosses losses;
  engine::Work damping_work;             ///< J

  /// Numbers that a checkpoint has to keep, apart from contacts and sums.
  struct Motion {
    Vec displacement{};  ///< of the centroid, m
    Vec velocity{};      ///< m/s
    Vec momentum{};      ///< angular, kg m2/s
    Vec spin{};          ///< of the half step that momentum belongs to, rad/s
    Quaternion attitude{1.0, 0.0, 0.0, 0.0};
    Vec angle_travelled{};  ///< x: sum of |omega| dt, rad
    Vec displacement_at_find{}, angle_at_find{};
  };
  Motion now;

 private:
  Vec spin_at(const Quaternion& q) const;
  Vec position() const { return start_ + now.displacement; }

  Polyhedron body_;  ///< in its principal axes, about the centroid
  double mass_ = 0.0, radius_ = 0.0, friction_ = 0.0;
  Vec inertia_{};  ///< principal, kg m2
  Vec start_{};    ///< centroid at the start, m
  bool rotates_ = true;
  Vec force_{}, torque_{};  ///< of the contacts, N, N m
  Vec old_velocity_{}, old_spin_{};
  Vec damping_force_{}, damping_torque_{};
  std::array<Vec, remembered_forces> recent_{};  ///< a ring, for histories finer than what is asked for
  std::size_t kicks_ = 0;                        ///< since the block was set
};

}  // namespace gabion::dem
