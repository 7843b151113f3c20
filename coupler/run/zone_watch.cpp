#include "coupler/run/zone_watch.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace gabion::coupler {

namespace {

constexpr const char* face_names[] = {"xmin", "xmax", "ymin", "ymax", "zmin", "zmax"};

std::string text_of(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%.2g", value);
  return text;
}

std::string per_cent(double share) { return text_of(100.0 * share) + " %"; }

}  // namespace

ZoneWatch::ZoneWatch(const Zone& zone, const GrainSet& grains, const InterfaceRows* rows)
    : zone_(zone), rows_(rows), mass_(grains.plain_mass), damage_(grains.position.size(), 0.0) {
  if (!rows_ || !zone.has_interface()) return;
  const std::size_t n = grains.radius.size();
  width_ = 2.0 * std::accumulate(grains.radius.begin(), grains.radius.end(), 0.0) / static_cast<double>(n);
  for (const std::int32_t c : rows_->hats.columns) hats_ = std::max(hats_, static_cast<std::size_t>(c) + 1);
  // edge-to-edge has no overlap: two diameters beside the border are looked at
  const double depth = std::max(zone.overlap(), 2.0 * width_);
  shells_a_face_ = static_cast<std::size_t>(std::ceil(depth / width_ - 1e-9));
  shells_.resize(6 * shells_a_face_);
  shell_.assign(n, -1);
  for (std::size_t g = 0; g < n; ++g) {
    const double inward = -zone.beyond_outer(grains.position[g]);
    const auto k = static_cast<std::size_t>(std::max(0.0, inward / width_));
    if (k < shells_a_face_)
      shell_[g] = static_cast<std::int32_t>(static_cast<std::size_t>(zone.nearest_outer_face(grains.position[g])) * shells_a_face_ + k);
  }
}

void ZoneWatch::look(std::span<const double> yield, std::span<const double> velocity) {
  looked_ = true;
  for (Shell& shell : shells_) shell.contacts = shell.damaged = 0.0;
  double contacts = 0.0, used = 0.0;
  for (std::size_t g = 0; g < damage_.size(); ++g) {
    const double all = yield[3 * g], damaged = yield[3 * g + 1];
    if (all > 0.0) damage_[g] = std::max(damage_[g], damaged / all);
    if (shell_.empty() || shell_[g] < 0) continue;
    Shell& shell = shells_[static_cast<std::size_t>(shell_[g])];
    shell.contacts += all;
    shell.damaged += damaged;
    contacts += all;
    used += damaged + yield[3 * g + 2];
  }
  for (Shell& shell : shells_)
    if (shell.contacts >= fewest_contacts) {
      shell.share = std::max(shell.share, shell.damaged / shell.contacts);
      // a contact counts with both of its grains: the count of damaged ones scatters by sqrt(2 damaged)
      shell.sure = std::max(shell.sure, (shell.damaged - std::sqrt(2.0 * shell.damaged)) / shell.contacts);
    }
  if (contacts > 0.0) yield_ratio_ = std::max(yield_ratio_, used / contacts);
  if (needs_velocity()) unresolved_ = std::max(unresolved_, unresolved(velocity));
}

double ZoneWatch::unresolved(std::span<const double> velocity) const {
  const SparseRows& hats = rows_->hats;
  std::vector<double> mass(hats_, 0.0), momentum(3 * hats_, 0.0);
  const auto each = [&](auto&& visit) {
    for (std::size_t t = 0; t < rows_->hat_grains.size(); ++t)
      for (std::int32_t k = hats.row_ptr[t]; k < hats.row_ptr[t + 1]; ++k)
        visit(t, static_cast<std::size_t>(rows_->hat_grains[t]), static_cast<std::size_t>(hats.columns[static_cast<std::size_t>(k)]),
              hats.values[static_cast<std::size_t>(k)]);
  };
  each([&](std::size_t t, std::size_t g, std::size_t hat, double phi) {
    const double share = phi * mass_[g] * rows_->share[t];
    mass[hat] += share;
    for (std::size_t axis = 0; axis < 3; ++axis) momentum[3 * hat + axis] += share * velocity[3 * g + axis];
  });
  std::vector<double> mean(3 * rows_->hat_grains.size(), 0.0);
  each([&](std::size_t t, std::size_t, std::size_t hat, double phi) {
    if (mass[hat] > 0.0)
      for (std::size_t axis = 0; axis < 3; ++axis) mean[3 * t + axis] += phi * momentum[3 * hat + axis] / mass[hat];
  });
  double energy = 0.0;
  for (std::size_t t = 0; t < rows_->hat_grains.size(); ++t) {
    const auto g = static_cast<std::size_t>(rows_->hat_grains[t]);
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const double beside = velocity[3 * g + axis] - mean[3 * t + axis];
      energy += 0.5 * mass_[g] * rows_->share[t] * beside * beside;
    }
  }
  return energy;
}

/// How far, m, damage came from the inner end of the overlap towards this face; 0: not into the overlap.
double ZoneWatch::depth_of_damage(int face) const {
  for (std::size_t k = 0; k < shells_a_face_; ++k)
    if (shells_[static_cast<std::size_t>(face) * shells_a_face_ + k].sure > tolerable_damage)
      return static_cast<double>(shells_a_face_ - k) * width_;
  return 0.0;
}

/// Largest share of a shell's contacts that yielded where the mesh should have done so. At a border the mesh has all beyond.
double ZoneWatch::missed(int face) const {
  double largest = 0.0;
  for (std::size_t k = 0; k < shells_a_face_; ++k) {
    const double share = shells_[static_cast<std::size_t>(face) * shells_a_face_ + k].sure;
    const double mesh = zone_.overlap() > 0.0 ? std::max(0.0, 1.0 - (static_cast<double>(k) + 0.5) * width_ / zone_.overlap()) : (k == 0 ? 1.0 : 0.0);
    largest = std::max(largest, mesh * share);
  }
  return largest;
}

bool ZoneWatch::large_enough() const {
  if (shells_.empty() || !looked_) return false;
  for (int face = 0; face < 6; ++face)
    if (missed(face) > tolerable_damage) return false;
  return true;
}

nlohmann::json ZoneWatch::verdict(double energy) const {
  if (shells_.empty() || !looked_) return nullptr;
  nlohmann::json result{{"yield_ratio", yield_ratio_}};
  double largest = 0.0, unfollowed = 0.0;
  nlohmann::json too_small = nlohmann::json::object(), profile = nlohmann::json::object();
  for (int face = 0; face < 6; ++face) {
    if (!std::isfinite(zone_.face_position(face))) continue;
    for (std::size_t k = 0; k < shells_a_face_; ++k) {
      const double share = shells_[static_cast<std::size_t>(face) * shells_a_face_ + k].share;
      profile[face_names[face]].push_back(share);
      largest = std::max(largest, share);
    }
    unfollowed = std::max(unfollowed, missed(face));
    if (missed(face) > tolerable_damage) too_small[face_names[face]] = depth_of_damage(face);
  }
  result["damaged_share"] = largest;
  result["missed_share"] = unfollowed;
  result["damaged_share_from_outer_face"] = profile;
  result["shell_width"] = width_;
  result["too_small_by"] = too_small;
  const double share = energy > 0.0 ? unresolved_ / energy : 0.0;
  if (needs_velocity()) result["unresolved_energy"] = share;
  result["large_enough"] = large_enough();
  result["mesh_fine_enough"] = share <= tolerable_energy;
  return result;
}

std::vector<std::string> ZoneWatch::advice(double energy, double tied_damage) const {
  std::vector<std::string> words;
  const nlohmann::json found = verdict(energy);
  if (tied_damage > tolerable_damage)
    words.push_back(per_cent(tied_damage) + " of the contacts of tied grains slid or broke, more than " + per_cent(tolerable_damage) +
                    (large_enough() ? ": only where the mesh carries little, so that the zone is large enough; a larger coupling.zone would leave none"
                                    : ": the mesh beside them cannot follow. Enlarge coupling.zone, so that the overlap or border lies in "
                                      "ground that stays elastic"));
  if (found.is_null()) return words;
  if (!found["large_enough"]) {
    const std::string place = zone_.overlap() > 0.0 ? "in the overlap" : "within two diameters of the border";
    std::string move = "the zone of the grains is too small: " + place + " up to " + per_cent(found["damaged_share"]) +
                       " of the contacts slid or broke, which makes " + per_cent(found["missed_share"]) + " of what the mesh carries, more than " +
                       per_cent(tolerable_damage) + ". Move its";
    for (const auto& [face, by] : found["too_small_by"].items()) {
      const bool through = by.get<double>() > (static_cast<double>(shells_a_face_) - 0.5) * width_;
      move += " " + face + " face out by " + (through ? "more than " : "about ") + text_of(by) + " m,";
    }
    move.back() = '.';
    words.push_back(move);
  }
  if (!found["mesh_fine_enough"])
    words.push_back("motion that the mesh cannot follow came to the overlap with " + per_cent(found["unresolved_energy"]) +
                    " of the run's energy: lower mesh.size, move the zone's faces out, or widen the overlap");
  return words;
}

nlohmann::json ZoneWatch::memory() const {
  std::vector<double> shares, sure;
  for (const Shell& shell : shells_) {
    shares.push_back(shell.share);
    sure.push_back(shell.sure);
  }
  return {{"damage", damage_}, {"shares", shares}, {"sure", sure}, {"yield_ratio", yield_ratio_}, {"unresolved", unresolved_}, {"looked", looked_}};
}

void ZoneWatch::remember(const nlohmann::json& memory) {
  memory.at("damage").get_to(damage_);
  const auto shares = memory.at("shares").get<std::vector<double>>(), sure = memory.at("sure").get<std::vector<double>>();
  for (std::size_t k = 0; k < std::min(shares.size(), shells_.size()); ++k) {
    shells_[k].share = shares[k];
    shells_[k].sure = sure.at(k);
  }
  yield_ratio_ = memory.at("yield_ratio");
  unresolved_ = memory.at("unresolved");
  looked_ = memory.at("looked");
}

}  // namespace gabion::coupler
