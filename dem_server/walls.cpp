#include "dem_server/walls.hpp"

#include <algorithm>

namespace gabion::dem {

void Walls::find(const ContactSource& source, const VecField& displacement, double margin) {
  std::vector<SurfaceContact> found;
  auto old = contacts.begin();
  const auto before = [](const SurfaceContact& a, std::int32_t wall, std::int32_t grain) {
    return a.surface != wall ? a.surface < wall : a.grain < grain;
  };
  for (std::size_t w = 0; w < walls.size(); ++w) {
    Wall& wall = walls[w];
    wall.travel_at_find = wall.travel;
    for (std::size_t i = 0; i < source.grains.size(); ++i) {
      const Vec from = source.rest[i] - wall.point + (displacement[i] - wall.travel);
      const double gap = dot(from, wall.normal) - source.grains.radius[i];
      if (gap > margin) continue;
      const auto surface = static_cast<std::int32_t>(w), grain = static_cast<std::int32_t>(i);
      while (old != contacts.end() && before(*old, surface, grain)) ++old;
      if (old != contacts.end() && old->surface == surface && old->grain == grain) {
        found.push_back(*old);
        continue;
      }
      SurfaceContact contact;
      contact.surface = surface;
      contact.grain = grain;
      set_parameters(contact, source.grains, i, wall.friction, INFINITY, source.weights.at(source.rest[i]));
      contact.normal = -wall.normal;
      contact.elongation = gap;
      found.push_back(contact);
    }
  }
  contacts = std::move(found);
}

double Walls::largest_travel() const {
  double largest = 0.0;
  for (const Wall& wall : walls)
    largest = std::max(largest, std::fabs(dot(wall.travel - wall.travel_at_find, wall.normal)));
  return largest;
}

double Walls::elongation(const Grains& grains, const engine::Motion& motion, const SurfaceContact& c) const {
  const Wall& wall = walls[c.surface];
  // rest and motion apart, so that small motions keep their digits
  return dot(motion.position[c.grain] - wall.point, wall.normal) - grains.radius[c.grain] +
         dot(motion.displacement[c.grain] - wall.travel, wall.normal);
}

void Walls::add_forces(const Grains& grains, double past_step, engine::Motion& motion, Rotation& rotation,
                       bool rotating) {
  for (SurfaceContact& c : contacts) {
    const Wall& wall = walls[c.surface];
    const double e = elongation(grains, motion, c);
    if (!(c.state & touching) && !(e < 0.0)) {
      c.elongation = e;
      c.force = Vec{};
      continue;
    }
    const Vec n = -wall.normal;
    const Vec lever = splat(contact_arm(grains.radius[c.grain], e)) * n;
    Vec slip = wall.velocity - motion.velocity[c.grain];
    double twist = 0.0;
    Vec spin{};
    if (rotating) {
      slip -= cross(rotation.spin[c.grain], lever);
      twist = 0.5 * dot(rotation.spin[c.grain], n);
      spin = -rotation.spin[c.grain];
    }
    losses += follow_surface(c, {e, n, slip, twist, spin}, past_step);
    if (!(c.state & touching)) continue;
    motion.force[c.grain] += c.force;
    if (rotating) rotation.torque[c.grain] += cross(lever, c.force) + c.couple();
  }
}

void Walls::drift(double dt) {
  double power = 0.0;
  for (const SurfaceContact& c : contacts) power += dot(c.force, walls[c.surface].velocity);
  work.add(0.5 * dt * power, 0.5 * dt * power);
  for (Wall& wall : walls) wall.travel += splat(dt) * wall.velocity;
}

VecField Walls::forces() const {
  VecField total(walls.size(), Vec{});
  for (const SurfaceContact& c : contacts) total[c.surface] += c.force;
  return total;
}

double Walls::energy() const {
  double total = 0.0;
  for (const SurfaceContact& c : contacts) total += c.energy();
  return total;
}

void Walls::add_springs(const Grains& grains, double near, std::vector<SurfaceSpring>& springs) const {
  for (const SurfaceContact& c : contacts)
    if (c.elongation <= near)
      springs.push_back({c.grain, c.normal, contact_arm(grains.radius[c.grain], std::min(c.elongation, 0.0)),
                         c.stiffness.normal, c.stiffness.shear, c.rolling.stiffness, c.damper});
}

}  // namespace gabion::dem
