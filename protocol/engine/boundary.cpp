#include "protocol/engine/boundary.hpp"

#include <algorithm>
#include <stdexcept>

namespace gabion::engine {

namespace {

void check_entities(const std::string& name, const std::vector<std::int32_t>& entities,
                    std::size_t points) {
  for (const std::int32_t e : entities)
    if (e < 0 || static_cast<std::size_t>(e) >= points)
      throw std::out_of_range("group '" + name + "' names entity " + std::to_string(e) + ", but there are " +
                              std::to_string(points));
}

template <class Group>
void add_or_replace(std::vector<Group>& groups, Group group) {
  const auto same = [&](const Group& other) { return other.name == group.name; };
  const auto found = std::find_if(groups.begin(), groups.end(), same);
  if (found != groups.end())
    *found = std::move(group);
  else
    groups.push_back(std::move(group));
}

/// 1 in the components that the bits x = 1, y = 2, z = 4 name.
Vec component_mask(std::uint8_t bits) {
  return vec(bits & 1 ? 1.0 : 0.0, bits & 2 ? 1.0 : 0.0, bits & 4 ? 1.0 : 0.0);
}

/// Places in a group's list among which all its entities in [first, last) are: lists that ascend are not looked through.
struct Places {
  std::size_t from, to;
};
Places places_of(const std::vector<std::int32_t>& entities, bool ascending, std::size_t first, std::size_t last) {
  if (!ascending) return {0, entities.size()};
  const auto at = [&](std::size_t entity) {
    const auto found = std::lower_bound(entities.begin(), entities.end(), entity,
                                        [](std::int32_t e, std::size_t limit) { return static_cast<std::size_t>(e) < limit; });
    return static_cast<std::size_t>(found - entities.begin());
  };
  return {at(first), at(last)};
}

bool within(std::int32_t entity, std::size_t first, std::size_t last) {
  return static_cast<std::size_t>(entity) >= first && static_cast<std::size_t>(entity) < last;
}

}  // namespace

void Boundary::add(Constraint constraint, std::size_t points) {
  check_entities(constraint.name, constraint.entities, points);
  constraint.ascending = std::is_sorted(constraint.entities.begin(), constraint.entities.end());
  add_or_replace(constraints_, std::move(constraint));
  reactions_.assign(3 * constraints_.size(), 0.0);
  parts_.assign(Work::most_tiers * reactions_.size(), 0.0);
}

void Boundary::add(Load load, std::size_t points) {
  check_entities(load.name, load.entities, points);
  load.ascending = std::is_sorted(load.entities.begin(), load.entities.end());
  add_or_replace(loads_, std::move(load));
}

void Boundary::add(Dashpot dashpot, std::size_t points) {
  check_entities(dashpot.name, dashpot.entities, points);
  add_or_replace(dashpots_, std::move(dashpot));
}

void Boundary::apply_to(Motion& motion) const {
  std::fill(motion.freedom.begin(), motion.freedom.end(), vec(1, 1, 1));
  for (const Constraint& c : constraints_)
    for (const std::int32_t e : c.entities) motion.freedom[e] *= vec(1, 1, 1) - component_mask(c.components);
  motion.viscosity.clear();
  for (const Dashpot& d : dashpots_) {
    if (d.entities.empty()) continue;
    motion.viscosity.resize(motion.size(), Vec{});
    for (std::size_t k = 0; k < d.entities.size(); ++k) motion.viscosity[d.entities[k]] += d.coefficients[k];
  }
}

void Boundary::add_loads(VecField& force, double time, std::size_t first, std::size_t last) const {
  for (const Load& load : loads_) {
    const double value = load.history.at(time);
    if (value == 0.0) continue;
    const Places places = places_of(load.entities, load.ascending, first, last);
    for (std::size_t k = places.from; k < places.to; ++k)
      if (within(load.entities[k], first, last)) force[load.entities[k]] += splat(value) * load.vectors[k];
  }
}

void Boundary::prescribe(Motion& motion, const StepContext& context, std::size_t first,
                         std::size_t last) const {
  for (const Constraint& c : constraints_) {
    const Vec mask = component_mask(c.components);
    const Vec v = mask * c.direction * splat(c.history.at(context.time + 0.5 * context.dt));
    const Vec rest = vec(1, 1, 1) - mask;
    const Places places = places_of(c.entities, c.ascending, first, last);
    for (std::size_t k = places.from; k < places.to; ++k) {
      const std::int32_t e = c.entities[k];
      if (within(e, first, last)) motion.velocity[e] = rest * motion.velocity[e] + v;
    }
  }
}

void Boundary::book(const Motion& motion, const StepContext& context, std::size_t from, std::size_t to, std::size_t tier) {
  double first = 0, second = 0;
  const std::size_t size = reactions_.size();
  const bool several = !motion.tiers.empty();
  const std::uint64_t period = several ? motion.tiers.back().rate : 1;
  const double share = several ? static_cast<double>(motion.tiers[tier].rate) / static_cast<double>(period) : 1.0;
  for (std::size_t g = 0; g < constraints_.size(); ++g) {
    const Constraint& c = constraints_[g];
    const Vec mask = component_mask(c.components);
    Vec reaction{};
    const Places places = places_of(c.entities, c.ascending, from, to);
    for (std::size_t k = places.from; k < places.to; ++k) {
      const std::int32_t e = c.entities[k];
      if (!within(e, from, to)) continue;
      Vec r = -mask * (motion.force[e] + motion.tie_force[e]);
      if (motion.measured) {  // with the inertia of a prescribed motion that changes speed
        r += mask * splat(motion.mass[e] / context.dt) * (motion.velocity[e] - motion.old_velocity[e]);
        first += dot(r, motion.old_velocity[e]);
        second += dot(r, motion.velocity[e]);
      }
      reaction += r;
    }
    for (std::size_t axis = 0; axis < 3; ++axis) {
      double& whole = reactions_[3 * g + axis];
      whole = reaction[static_cast<int>(axis)];
      if (!several) continue;
      double& part = parts_[tier * size + 3 * g + axis];
      part = (context.step % period == 0 ? 0.0 : part) + share * whole;
      whole = 0.0;
      for (std::size_t t = 0; t < motion.tiers.size(); ++t) whole += parts_[t * size + 3 * g + axis];
    }
  }
  if (!motion.measured) return;
  constraint_work.add(0.5 * context.dt * first, 0.5 * context.dt * second, tier);
  first = second = 0;
  for (const Load& load : loads_) {
    const double value = load.history.at(context.time);
    if (value == 0.0) continue;
    const Places places = places_of(load.entities, load.ascending, from, to);
    for (std::size_t k = places.from; k < places.to; ++k) {
      if (!within(load.entities[k], from, to)) continue;
      const Vec f = splat(value) * load.vectors[k];
      first += dot(f, motion.old_velocity[load.entities[k]]);
      second += dot(f, motion.velocity[load.entities[k]]);
    }
  }
  load_power_before_ = first;
  load_work.add(0.5 * context.dt * first, 0.5 * context.dt * second, tier);
}

std::vector<std::string> Boundary::constraint_names() const {
  std::vector<std::string> names;
  for (const Constraint& c : constraints_) names.push_back(c.name);
  return names;
}

}  // namespace gabion::engine
