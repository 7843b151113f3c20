#pragma once
// Springs whose normals and branches stay as built: forces linear in displacements and rotations.
// Frozen geometry runs on it; the stable step of any geometry is found on it.

#include <cstdint>
#include <vector>

#include "dem_server/contact_table.hpp"
#include "dem_server/pair_buffer.hpp"

namespace gabion::dem {

/// A spring between two grains, or (j == none) between a grain and something that does not move.
struct LinearContact {
  Vec normal;           ///< from i to j; fourth: k_s, N/m
  double arm_i, arm_j;  ///< m
  double excess;        ///< k_n - k_s, N/m
  double spare = 0.0;
};

/// A spring from a grain to a rigid surface.
struct SurfaceSpring {
  std::int32_t grain;
  Vec normal;
  double arm;                                ///< m
  double normal_stiffness, shear_stiffness;  ///< N/m
  double rolling_stiffness = 0.0;            ///< N m
  ContactDamper damper;
};

/// Largest eigenvalues of M^-1 K, (rad/s)^2, and of M^-1 C, 1/s, C being the dashpots of contacts.
struct Spectra {
  double stiffness = 0.0, viscosity = 0.0;
};

class LinearNetwork {
 public:
  /// The springs of the pairs that are bonded or whose gap is at most near (elongation <= near, m), with
  /// the normals that displacement u gives.
  void build(const ContactTable& table, const VecField& u, double near);
  void add_surface(std::vector<SurfaceSpring> springs) { surface_ = std::move(springs); }
  /// The rolling springs of the pairs that build takes, bonds only where they can break.
  void add_rolling(const ContactTable& table, const VecField& u, double near);
  /// Dashpots in the place of springs: the same pairs as in add_rolling, and the surfaces'.
  void build_dashpots(const ContactTable& table, const VecField& u, double near, std::vector<SurfaceSpring> surfaces);

  std::size_t size() const { return second_.size(); }
  const std::vector<std::int32_t>& start() const { return start_; }
  const std::vector<std::int32_t>& second() const { return second_; }
  const std::vector<LinearContact>& contacts() const { return contacts_; }

  /// Adds the forces of the pairs whose first grain is in [first, last), as the contact phase of a
  /// step; angles and torques may be empty when grains do not rotate. Calls in ascending order of
  /// ranges that cover all grains give the whole force. threads > 1: grains [first, last) are then
  /// complete, provided all earlier ranges were done.
  void add_forces(std::size_t first, std::size_t last, const VecField& displacement, const VecField& angle,
                  VecField& force, VecField& torque, bool rotating, int threads);

  /// 1/2 sum k_n e^2 + k_s s^2, J.
  double energy(const VecField& displacement, const VecField& angle, bool rotating) const;

  /// Force of contact c of grain i on it, N.
  Vec force(std::size_t i, std::size_t c, const VecField& displacement, const VecField& angle, bool rotating) const;

 private:
  struct RollingSpring {
    std::int32_t i, j;
    Vec normal;
    double stiffness;  ///< N m
  };
  void take(const ContactTable& table, std::size_t c, const Reach& reach, double normal, double shear);
  void add_couples(const VecField& angle, VecField& torque) const;

  std::vector<std::int32_t> start_{0}, second_;
  std::vector<LinearContact> contacts_;
  std::vector<SurfaceSpring> surface_;
  std::vector<RollingSpring> rolling_;
  PairBuffer buffer_;
  bool connected_ = false;
};

}  // namespace gabion::dem
