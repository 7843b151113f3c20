// DemEngine: fields by name.

#include <cmath>
#include <functional>
#include <map>
#include <string>

#include "dem_server/engine.hpp"

namespace gabion::dem {
namespace {

using Shape = std::vector<std::uint64_t>;

std::vector<double> flat(const VecField& field, Shape& shape) {
  shape = {field.size(), 3};
  std::vector<double> values;
  values.reserve(3 * field.size());
  for (const Vec v : field) values.insert(values.end(), {v[0], v[1], v[2]});
  return values;
}

std::vector<double> column(std::vector<double> values, Shape& shape) {
  shape = {values.size()};
  return values;
}

std::vector<double> table(std::vector<double> values, std::uint64_t width, Shape& shape) {
  shape = {values.size() / width, width};
  return values;
}

}  // namespace

std::vector<std::string> DemEngine::field_names() {
  return {"position", "displacement", "velocity", "rotation", "spin",      "force", "radius",    "mass",
          "weight",   "contact",      "broken",   "lost",     "tie_force", "block", "block_forces", "wall_force",
          "clump",    "yield"};
}

std::optional<std::vector<double>> DemEngine::field(const std::string& name, Shape& shape) const {
  using Getter = std::function<std::vector<double>()>;
  const std::map<std::string, Getter> getters{
      {"position", [&] { return flat(motion.position, shape); }},
      {"displacement", [&] { return flat(motion.displacement, shape); }},
      {"velocity", [&] { return flat(motion.velocity, shape); }},
      {"rotation", [&] { return flat(rotation_.angle, shape); }},
      {"spin", [&] { return flat(rotation_.spin, shape); }},
      {"force", [&] { return flat(motion.force, shape); }},
      {"tie_force", [&] { return flat(motion.tie_force, shape); }},
      {"radius", [&] { return column(grains_.radius, shape); }},
      {"mass", [&] { return column(motion.mass, shape); }},
      {"weight",
       [&] {
         std::vector<double> w(motion.mass);
         for (std::size_t i = 0; i < w.size(); ++i) w[i] /= motion.plain_mass[i];
         return column(std::move(w), shape);
       }},
      {"contact", [&] { return table(contact_rows(), 8, shape); }},
      {"broken",
       [&] {
         return column({contact_.broken_of.begin(), contact_.broken_of.end()}, shape);
       }},
      {"yield", [&] { return table(yield_rows(), 3, shape); }},
      {"lost",
       [&] {
         std::vector<double> flags(grains_.size(), 0.0);
         for (const std::int32_t g : lost_) flags[g] = 1.0;
         return column(std::move(flags), shape);
       }},
      {"block",
       [&] {
         std::vector<double> state = block_.present() ? block_.state() : std::vector<double>{};
         shape = {state.empty() ? 0u : 1u, state.size()};
         return state;
       }},
      {"block_forces", [&] { return flat(block_.present() ? block_.recent_forces() : VecField{}, shape); }},
      {"clump",
       [&] {
         const std::vector<std::int32_t>& of = clumps_.body_of();
         return column(
             of.empty() ? std::vector<double>(grains_.size(), -1.0) : std::vector<double>(of.begin(), of.end()), shape);
       }},
      {"wall_force", [&] { return flat(walls_.forces(), shape); }},
  };
  const auto found = getters.find(name);
  if (found == getters.end()) return std::nullopt;
  return found->second();
}

void DemEngine::set_field(const std::string& name, std::span<const double> values) {
  const std::map<std::string, VecField*> targets{{"displacement", &motion.displacement},
                                                 {"velocity", &motion.velocity},
                                                 {"rotation", &rotation_.angle},
                                                 {"spin", &rotation_.spin}};
  const auto found = targets.find(name);
  if (found == targets.end())
    throw engine::RequestError("SET_FIELD field", "no field '" + name + "' to set",
                               "known: displacement, velocity, rotation, spin");
  if (values.size() != 3 * grains_.size())
    throw engine::RequestError(
        "SET_FIELD values", std::to_string(values.size()) + " values for " + std::to_string(grains_.size()) + " grains",
        "send three per grain");
  for (std::size_t k = 0; k < values.size(); ++k)
    if (!std::isfinite(values[k]))
      throw engine::RequestError("SET_FIELD values", "value of grain " + std::to_string(k / 3) + " is not finite",
                                 "send finite numbers");
  finish_last_step();
  VecField& field = *found->second;
  for (std::size_t i = 0; i < grains_.size(); ++i) field[i] = vec(values[3 * i], values[3 * i + 1], values[3 * i + 2]);
  if (&field == &rotation_.spin)
    for (std::size_t i = 0; i < grains_.size(); ++i)
      if (!grains_.material_of(i).rotates) field[i] = Vec{};
  if (!clumps_.empty()) {
    if (name == "displacement") clumps_.take_displacement(motion);
    if (name == "velocity") clumps_.take_velocity(motion, rotation_);
    if (name == "spin") clumps_.take_spin(motion, rotation_);
    if (name == "rotation") clumps_.take_angle(rotation_);
  }
  const bool moves = found->second == &motion.displacement || found->second == &rotation_.angle;
  if (moves && contact_options_.geometry == Geometry::updated)
    contact_.springs_from_displacements(motion.displacement, rotation_.angle);
}

}  // namespace gabion::dem
