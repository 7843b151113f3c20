#pragma once
// Prescribed velocities, loads and dashpots on groups of points; the same for grains and nodes.

#include <cstdint>
#include <string>
#include <vector>

#include "protocol/engine/history.hpp"
#include "protocol/engine/motion.hpp"

namespace gabion::engine {

/// Prescribes components of the velocity of a group: direction * history(t).
struct Constraint {
  std::string name;
  std::vector<std::int32_t> entities;
  std::uint8_t components = 0;  ///< bits x = 1, y = 2, z = 4, rotations = 8 (grains)
  Vec direction{};              ///< m/s per unit of the history
  History history;
  bool ascending = false;  ///< the entities; found out when it is added
};

/// Forces on a group: vector * history(t).
struct Load {
  std::string name;
  std::vector<std::int32_t> entities;
  VecField vectors;  ///< N per unit of the history
  History history;
  bool ascending = false;  ///< the entities; found out when it is added
};

/// Viscous absorbers on a group.
struct Dashpot {
  std::string name;
  std::vector<std::int32_t> entities;
  VecField coefficients;  ///< N s/m
};

class Boundary {
 public:
  /// Adds the group, or replaces the one of the same name. std::out_of_range names the entity that
  /// does not exist.
  void add(Constraint constraint, std::size_t points);
  void add(Load load, std::size_t points);
  void add(Dashpot dashpot, std::size_t points);

  /// Writes freedom and viscosity of the motion.
  void apply_to(Motion& motion) const;

  /// Adds the loads at context.time to motion.force, or at a time to the forces of the points [first, last).
  void add_loads(Motion& motion, const StepContext& context) const { add_loads(motion.force, context.time, 0, motion.size()); }
  void add_loads(VecField& force, double time, std::size_t first, std::size_t last) const;

  /// Sets the prescribed velocity components, at t_n + dt/2, of entities in [first, last).
  void prescribe(Motion& motion, const StepContext& context, std::size_t first,
                 std::size_t last) const;

  /// After the correction: reactions of the groups, and (ledger on) the work of loads and constraints.
  void book(const Motion& motion, const StepContext& context) { book(motion, context, 0, motion.size(), 0); }
  /// The same for the points [first, last) of a tier, context being the tier's own; reactions are then means over the
  /// period of the coarsest tier, whose impulses come in one step of it.
  void book(const Motion& motion, const StepContext& context, std::size_t first, std::size_t last, std::size_t tier);

  std::vector<std::string> constraint_names() const;
  /// Force of each constraint on its group in the last step, N, [groups][3].
  const std::vector<double>& reactions() const { return reactions_; }

  const std::vector<Constraint>& constraints() const { return constraints_; }
  bool rotations_locked(std::size_t group) const { return (constraints_[group].components & 8) != 0; }

  /// sum of F_n . v(n-1/2) over the loads of the last step that was booked, W.
  double load_power_before() const { return load_power_before_; }

  Work load_work;        ///< J
  Work constraint_work;  ///< J

 private:
  std::vector<Constraint> constraints_;
  std::vector<Load> loads_;
  std::vector<Dashpot> dashpots_;
  std::vector<double> reactions_;
  double load_power_before_ = 0.0;
  std::vector<double> parts_;  ///< of the reactions, [tiers][groups][3]
};

}  // namespace gabion::engine
