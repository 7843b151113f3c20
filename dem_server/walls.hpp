#pragma once
// Rigid plane walls that move at constant velocity.

#include <vector>

#include "dem_server/linear_network.hpp"
#include "dem_server/rotation.hpp"
#include "dem_server/surface_contact.hpp"

namespace gabion::dem {

struct Wall {
  Vec point{};            ///< at the start, m
  Vec normal{};           ///< unit vector into the grains
  double friction = 0.0;  ///< Coulomb coefficient, this one alone counts
  Vec velocity{};         ///< m/s
  Vec travel{};           ///< since the start, m
  Vec travel_at_find{};   ///< at the last search, m
};

class Walls {
 public:
  std::vector<Wall> walls;
  std::vector<SurfaceContact> contacts;  ///< sorted by (wall, grain), near pairs included
  ContactLosses losses;
  engine::Work work;                     ///< of the walls on the grains, J

  bool empty() const { return walls.empty(); }

  /// Lists the grains within margin of each wall; contacts keep their history.
  void find(const ContactSource& source, const VecField& displacement, double margin);
  /// Distance a wall has moved since find, largest, m.
  double largest_travel() const;

  /// Adds the forces at t_n.
  void add_forces(const Grains& grains, double past_step, engine::Motion& motion, Rotation& rotation, bool rotating);
  /// Books the work and moves the walls.
  void drift(double dt);

  double energy() const;
  /// Force of each wall on the grains in the last step, N.
  VecField forces() const;
  void add_springs(const Grains& grains, double near, std::vector<SurfaceSpring>& springs) const;

 private:
  double elongation(const Grains& grains, const engine::Motion& motion, const SurfaceContact& c) const;
};

}  // namespace gabion::dem
