#pragma once
// Forces of contacts that follow the grains: normals, shear springs and friction of updated geometry.

#include <cstdint>
#include <vector>

#include "dem_server/contact_table.hpp"
#include "dem_server/dissipation.hpp"
#include "dem_server/pair_buffer.hpp"
#include "dem_server/rotation.hpp"
#include "protocol/engine/motion.hpp"

namespace gabion::dem {

/// The same for a block of grains in one step.
struct ContactSums {
  ContactLosses losses;
  std::int32_t breaks = 0;
  Vec virial{};  ///< of a stretched ground only, N m
};

enum class LawKind { elastic_bond, breakable_bond, friction };

class ContactForces {
 public:
  ContactTable table;
  LawKind law = LawKind::friction;
  bool rotating = true;
  bool rolling = false;  ///< some material resists rolling
  bool damped = false;   ///< some material has a restitution below 1
  int threads = 1;
  ContactLosses losses;
  std::uint64_t breaks = 0;                   ///< bonds broken since the start
  std::vector<std::int32_t> broken_of;        ///< broken bonds per grain
  std::vector<std::int32_t> broken_as_first;  ///< the same, counted at the pair's first grain only

  bool stretched = false;  ///< the ground may be strained between steps, see DemEngine::stretch
  Vec strain_rate{};       ///< of the last such strain, over the branches it led to, 1/s
  VecField lever;          ///< arms of the grains in their clumps after it, m; empty without clumps
  Vec virial{};            ///< when stretched: sum of force on i times branch from body to body, x y z, at the last call, N m

  /// Call when the table was replaced.
  void table_changed(std::size_t grains);

  /// Adds the forces of pairs whose first grain is in [first, last), and moves their springs along by
  /// the last step: past_step is the dt of the drift that led here, s, or 0 when there was none.
  /// Ranges must come in ascending order; with several threads the grains of the range are complete.
  void add(std::size_t first, std::size_t last, double past_step, const Grains& grains, engine::Motion& motion,
           Rotation& rotation);

  /// Shear springs of unbroken bonds := what the total displacements and rotations give.
  void springs_from_displacements(const VecField& displacement, const VecField& angle);

  /// 1/2 sum k_n e^2 + k_s s^2 + k_r theta^2 of what is bonded or touching, J.
  double energy(const VecField& displacement) const;

  /// Force of pair c on its first grain, N, at these displacements and with the springs of the last step.
  Vec force(std::size_t i, std::size_t c, const VecField& displacement) const;

 private:
  void book_breaks(std::size_t first, std::size_t last);

  PairBuffer buffer_;
  std::vector<ContactSums> sums_;
};

}  // namespace gabion::dem
