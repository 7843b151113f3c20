#pragma once
// Energies by name. Stored energies and sums of work; what left the system is positive as "lost".

#include <string>
#include <vector>

namespace gabion::engine {

/// Each entry is one column of energy.csv. The balance that must stay constant is
///   sum of stored and lost entries - sum of work entries; what stands aside is told and not summed.
struct Ledger {
  enum class Kind { stored, lost, work, aside };
  struct Entry {
    std::string name;  ///< kinetic, elastic, gravity, friction, rolling, contact_damping, broken_bonds, switching, damping, dashpots, sponge, step_change, loads, constraints, multipliers, rate_swing
    Kind kind;
    double energy;  ///< J
  };
  std::vector<Entry> entries;

  void add(std::string name, Kind kind, double energy) { entries.push_back({std::move(name), kind, energy}); }
  double balance() const {
    double total = 0.0;
    for (const Entry& e : entries) total += e.kind == Kind::work ? -e.energy : e.kind == Kind::aside ? 0.0 : e.energy;
    return total;
  }
};

}  // namespace gabion::engine
