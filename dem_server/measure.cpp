// DemEngine: energies, counts and fields.

#include <algorithm>
#include <cmath>
#include <string>

#include "dem_server/engine.hpp"

namespace gabion::dem {

using engine::Ledger;
using engine::PhysicsError;

/// Before the drift: positions are those of t_n.
void DemEngine::measure_potentials() {
  if (!motion.measured) return;
  elastic_ = elastic_energy();
  gravity_ = block_.present() ? block_.gravity_energy(options.gravity) : 0.0;
  for (std::size_t i = 0; i < grains_.size(); ++i)
    gravity_ -= motion.mass[i] * dot(options.gravity, motion.displacement[i]);
}

/// After the drift, which books the work of damping, dashpots and walls.
void DemEngine::close_ledger() {
  check_motion();
  count_lost();
  if (!motion.measured) return;
  const double moving = block_.present() ? block_.kinetic_energy() : 0.0;
  const double turning = block_.present() ? block_.rotational_energy() : 0.0;
  const double clumps_moving = clumps_.empty() ? 0.0 : clumps_.kinetic_difference(motion);
  const double clumps_turning = clumps_.empty() ? 0.0 : clumps_.rotational_difference(rotation_);
  const double damped = motion.damping_work.until_now() + rotation_.damping_work.until_now() +
                        block_.damping_work.until_now() + clumps_.damping_work.until_now();
  ledger_ = {};
  ledger_.add("kinetic", Ledger::Kind::stored, motion.kinetic_energy() + clumps_moving + moving);
  ledger_.add("rotational", Ledger::Kind::stored,
              (contact_options_.rotations ? rotation_.kinetic_energy() : 0.0) + clumps_turning + turning);
  ledger_.add("elastic", Ledger::Kind::stored, elastic_);
  ledger_.add("gravity", Ledger::Kind::stored, gravity_);
  ContactLosses lost = contact_.losses;
  lost += walls_.losses;
  lost += block_.losses;
  ledger_.add("friction", Ledger::Kind::lost, lost.friction);
  ledger_.add("rolling", Ledger::Kind::lost, lost.rolling);
  ledger_.add("contact_damping", Ledger::Kind::lost, lost.damping);
  ledger_.add("broken_bonds", Ledger::Kind::lost, lost.broken);
  ledger_.add("switching", Ledger::Kind::lost, lost.switching);
  ledger_.add("damping", Ledger::Kind::lost, -damped);
  ledger_.add("dashpots", Ledger::Kind::lost, -motion.dashpot_work.until_now());
  ledger_.add("sponge", Ledger::Kind::lost, -sponge_.work.until_now());
  ledger_.add("step_change", Ledger::Kind::lost, step_change_);
  ledger_.add("loads", Ledger::Kind::work, boundary.load_work.until_now());
  ledger_.add("constraints", Ledger::Kind::work, boundary.constraint_work.until_now());
  ledger_.add("multipliers", Ledger::Kind::work, tie.work.until_now());
  ledger_.add("walls", Ledger::Kind::work, walls_.work.until_now());
}

double DemEngine::elastic_energy() const {
  if (contact_options_.geometry == Geometry::frozen)
    return frozen_.energy(motion.displacement, rotation_.angle, contact_options_.rotations);
  return contact_.energy(motion.displacement) + walls_.energy() + block_.elastic_energy();
}

void DemEngine::check_motion() const {
  for (std::size_t i = 0; i < grains_.size(); ++i) {
    const double way = norm(motion.velocity[i]) * past_step_;
    if (!std::isfinite(sum(motion.displacement[i]) + sum(motion.velocity[i]) + sum(rotation_.spin[i])))
      throw PhysicsError("grain " + std::to_string(i), "its motion is not a finite number",
                         "reduce the step, or look for the load or constraint that drives it");
    if (way > grains_.radius[i])
      throw PhysicsError("grain " + std::to_string(i),
                         "it moved " + std::to_string(way) + " m in one step, more than its radius of " +
                             std::to_string(grains_.radius[i]) + " m",
                         "the step is too large, or grains overlapped at the start");
  }
}

void DemEngine::count_lost() {
  // ejected grains may fly above the box: lost is who is a whole box away from it
  lost_.clear();
  fast_ = 0;
  Vec lo = options.box_lo, hi = options.box_hi;
  double size = 0.0;
  for (int axis = 0; axis < 3; ++axis) size = std::max(size, hi[axis] - lo[axis]);
  for (std::size_t i = 0; i < grains_.size(); ++i) {
    if (skin_ > 0.0 && norm(motion.velocity[i]) * past_step_ > skin_) ++fast_;
    const Vec x = motion.position[i] + motion.displacement[i];
    bool outside = false;
    for (int axis = 0; axis < 3; ++axis)
      if (hi[axis] > lo[axis] && !options.periodic[axis])
        outside = outside || x[axis] < lo[axis] - size || x[axis] > hi[axis] + size;
    if (outside) lost_.push_back(static_cast<std::int32_t>(i));
  }
}

std::vector<engine::NamedCount> DemEngine::counters() const {
  const ContactTable& table = contact_.table;
  const std::size_t reach = tie.reach();
  double contacts = 0, bonds = 0, slides = 0, tied_contacts = 0, tied_sliding = 0, tied_broken = 0;
  table.each([&](std::size_t i, std::size_t c) {
    const std::uint8_t state = table.state[c];
    if (!(state & (bonded | touching))) return;
    ++contacts;
    if (state & bonded) ++bonds;
    if (state & sliding) ++slides;
    if (i >= reach) return;
    ++tied_contacts;
    if (state & sliding) ++tied_sliding;
  });
  for (std::size_t i = 0; i < std::min(reach, contact_.broken_as_first.size()); ++i)
    tied_broken += contact_.broken_as_first[i];
  double surface_contacts = 0;
  for (const auto* list : {&walls_.contacts, &block_.contacts})
    for (const SurfaceContact& c : *list) surface_contacts += c.state & touching ? 1 : 0;
  std::vector<engine::NamedCount> counts{{"grains", static_cast<double>(grains_.size())},
                                         {"contacts", contacts},
                                         {"bonds", bonds},
                                         {"broken", static_cast<double>(contact_.breaks)},
                                         {"sliding", slides},
                                         {"lost", static_cast<double>(lost_.size())},
                                         {"fast", static_cast<double>(fast_)},
                                         {"rebuilds", static_cast<double>(rebuilds_)},
                                         {"surface_contacts", surface_contacts},
                                         {"tied_contacts", tied_contacts},
                                         {"tied_sliding", tied_sliding},
                                         {"tied_broken", tied_broken}};
  if (!clumps_.empty()) counts.push_back({"clumps", static_cast<double>(clumps_.size())});
  return counts;
}

std::vector<double> DemEngine::contact_rows() const {
  const ContactTable& table = contact_.table;
  const bool frozen = contact_options_.geometry == Geometry::frozen;
  std::vector<double> rows;
  table.each([&](std::size_t i, std::size_t c) {
    if (!(table.state[c] & (bonded | touching))) return;
    const auto j = static_cast<std::size_t>(table.second[c]);
    const Reach reach = reach_of(table, c, motion.displacement[j] - motion.displacement[i]);
    const Vec n = frozen ? frozen_.contacts()[c].normal : reach.branch / splat(reach.distance);
    const Vec f = frozen ? frozen_.force(i, c, motion.displacement, rotation_.angle, contact_options_.rotations)
                         : contact_.force(i, c, motion.displacement);
    rows.insert(rows.end(), {static_cast<double>(i), static_cast<double>(j), n[0], n[1], n[2], f[0], f[1], f[2]});
  });
  return rows;
}

namespace {

/// 0 to 1; a limit of zero is used up by anything.
double share_of(double force, double limit) {
  if (!(force > 0.0)) return 0.0;
  return limit > force ? force / limit : 1.0;
}

}  // namespace

/// Per grain: its contacts, broken bonds included; those of them that slide or are broken; sum of what the others
/// use of their strength, each from 0 to 1 (shear over Coulomb's limit, or tension and shear over the bond's strengths).
std::vector<double> DemEngine::yield_rows() const {
  const ContactTable& table = contact_.table;
  std::vector<double> rows(3 * grains_.size(), 0.0);
  for (std::size_t i = 0; i < contact_.broken_of.size(); ++i)
    rows[3 * i] = rows[3 * i + 1] = static_cast<double>(contact_.broken_of[i]);
  if (contact_options_.geometry == Geometry::frozen) return rows;
  table.each([&](std::size_t i, std::size_t c) {
    const std::uint8_t state = table.state[c];
    if (!(state & (bonded | touching)) || state & counted) return;
    const auto j = static_cast<std::size_t>(table.second[c]);
    const ContactSpring& k = table.stiffness[c];
    const double tension = k.normal * reach_of(table, c, motion.displacement[j] - motion.displacement[i]).elongation;
    const double shear = k.shear * norm(table.spring[c] * vec(1, 1, 1));
    double used = 0.0;
    if (state & touching)
      used = share_of(shear, -k.friction * tension);
    else if (!table.strength.empty())
      used = std::max(share_of(tension, table.strength[c].tensile), share_of(shear, table.strength[c].shear));
    for (const std::size_t g : {i, j}) {
      rows[3 * g] += 1.0;
      rows[3 * g + 1] += state & sliding ? 1.0 : 0.0;
      rows[3 * g + 2] += state & sliding ? 0.0 : used;
    }
  });
  return rows;
}

double DemEngine::mean_contact_force() const {
  const std::vector<double> rows = contact_rows();
  double total = 0.0;
  std::size_t count = rows.size() / 8;
  for (std::size_t r = 0; r < rows.size(); r += 8) total += std::hypot(rows[r + 5], rows[r + 6], rows[r + 7]);
  for (const auto* list : {&walls_.contacts, &block_.contacts})
    for (const SurfaceContact& c : *list)
      if (c.state & touching) {
        total += norm(c.force);
        ++count;
      }
  return count == 0 ? 0.0 : total / static_cast<double>(count);
}

double DemEngine::unbalanced() const {
  const double force = clumps_.empty() ? motion.mean_unbalanced_force() : clumps_.mean_unbalanced_force(motion);
  const double scale = mean_contact_force();
  if (scale > 0.0) return force / scale;
  return force > 0.0 ? 1.0 : 0.0;
}

std::vector<double> DemEngine::momentum() const {
  std::vector<double> total = motion.momentum();
  Vec spins = rotation_.momentum();
  if (!clumps_.empty()) spins += clumps_.angular_momentum_difference(motion, rotation_);
  for (int axis = 0; axis < 3; ++axis) total[3 + axis] += spins[axis];
  if (!block_.present()) return total;
  const std::vector<double> block = block_.momentum();
  for (std::size_t k = 0; k < total.size(); ++k) total[k] += block[k];
  return total;
}

}  // namespace gabion::dem
