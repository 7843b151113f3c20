#include "dem_server/packing/packing.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "dem_server/packing/bonding_gap.hpp"
#include "dem_server/packing/homogeneity.hpp"
#include "dem_server/packing/radii.hpp"
#include "dem_server/packing/relaxation.hpp"
#include "protocol/engine/engine.hpp"

namespace gabion::dem {
namespace {

constexpr double least_fraction = 0.05, largest_fraction = 0.74;
constexpr double most_contacts = 12.0;
// Thickness that a flat face takes away from the space a dense packing fills, in mean diameters by
// volume: spheres cannot reach across the face, so the layer along it is looser. Measured on boxes of
// 2 000 to 20 000 grains with size ratio 2 (0.117 to 0.124).
constexpr double face_loss = 0.118;

void check(const PackingRequest& request, const RadiusDistribution& distribution) {
  const auto refuse = [](const std::string& field, const std::string& message, const std::string& advice) {
    throw engine::RequestError("PACK " + field, message, advice);
  };
  for (int a = 0; a < 3; ++a) {
    const double side = request.box.hi[a] - request.box.lo[a];
    if (!(side >= 4.0 * distribution.largest()) || !std::isfinite(side))
      refuse("box",
             "side " + std::to_string(side) + " m along axis " + std::to_string(a) + " is below two largest diameters",
             "enlarge the box or take smaller grains");
  }
  if (!(request.solid_fraction >= least_fraction && request.solid_fraction <= largest_fraction))
    refuse("solid_fraction", std::to_string(request.solid_fraction) + " is not between 0.05 and 0.74",
           "0.60 to 0.64 for a dense packing");
  if (!(request.contacts_per_grain >= 0.0 && request.contacts_per_grain <= most_contacts))
    refuse("contacts_per_grain", std::to_string(request.contacts_per_grain) + " is not between 0 and 12",
           "5 to 8 for a bonded packing");
}

/// Volume that grains fill as densely as the inside of a packing does.
double filled_volume(const PackingRequest& request, double mean_radius_by_volume) {
  double volume = 1.0;
  for (int a = 0; a < 3; ++a)
    volume *= request.box.period(a) - (request.box.periodic[a] ? 0.0 : 2.0 * face_loss * 2.0 * mean_radius_by_volume);
  return volume;
}

VecField random_places(const PackingRequest& request, std::size_t grains, Random& random) {
  const Vec side = request.box.hi - request.box.lo;
  VecField places(grains);
  for (Vec& x : places)
    for (int a = 0; a < 3; ++a) x[a] = request.box.lo[a] + random.uniform() * side[a];
  // Ordered by small cubes, so that neighbours in space are near in memory. (Places are sorted through
  // their indices: std::stable_sort's own buffer is not aligned for Vec.)
  const double cube = 3.0 * std::cbrt(side[0] * side[1] * side[2] / static_cast<double>(grains));
  std::vector<std::array<std::int64_t, 4>> keys(grains);
  for (std::size_t g = 0; g < grains; ++g) {
    for (int a = 0; a < 3; ++a) keys[g][2 - a] = static_cast<std::int64_t>((places[g][a] - request.box.lo[a]) / cube);
    keys[g][3] = static_cast<std::int64_t>(g);
  }
  std::sort(keys.begin(), keys.end());
  VecField ordered;
  for (const auto& key : keys) ordered.push_back(places[static_cast<std::size_t>(key[3])]);
  return ordered;
}

RelaxationOutcome grow_and_relax(VecField& centres, const std::vector<double>& radii, const Domain& box) {
  struct Stage {
    double scale;
    RelaxationLimits limits;
  };
  // Coarse removal of overlaps while growing, then until nothing moves at full size
  constexpr Stage stages[] = {{0.7, {60, 1e-3, 1e-2}}, {0.9, {60, 1e-3, 1e-2}}, {1.0, {6000, 1e-6, 1e-5}}};
  Relaxation relaxation(centres, radii, box);
  RelaxationOutcome outcome;
  int steps = 0;
  for (const Stage& stage : stages) {
    outcome = relaxation.run(stage.scale, stage.limits);
    steps += outcome.steps;
  }
  outcome.steps = steps;
  return outcome;
}

}  // namespace

Packing make_packing(const PackingRequest& request) {
  const RadiusDistribution distribution(request.radius_kind, request.radius);
  check(request, distribution);
  Random random(request.seed);
  const double filled = filled_volume(request, distribution.mean_radius_by_volume());
  const std::vector<double> radii = draw_radii(distribution, request.solid_fraction * filled, random);
  VecField centres = random_places(request, radii.size(), random);
  const RelaxationOutcome relaxed = grow_and_relax(centres, radii, request.box);
  const BondingGap bonding =
      find_bonding_gap(centres, radii, request.box, request.contacts_per_grain, request.min_contacts);

  Packing packing;
  double solid = 0.0;
  for (std::size_t i = 0; i < radii.size(); ++i) {
    solid += 4.0 / 3.0 * std::numbers::pi * radii[i] * radii[i] * radii[i];
    if (!bonding.kept[i]) continue;
    packing.position.push_back(centres[i]);
    packing.radius.push_back(radii[i]);
  }
  packing.gap = bonding.gap;
  packing.contacts_per_grain = bonding.contacts_per_grain;
  packing.solid_fraction = inner_solid_fraction(centres, radii, request.box);
  packing.box_fraction = solid / (request.box.period(0) * request.box.period(1) * request.box.period(2));
  if (std::isnan(packing.solid_fraction)) packing.solid_fraction = solid / filled;
  packing.rattlers = radii.size() - packing.radius.size();
  packing.residual_overlap = relaxed.touching > 0 ? relaxed.mean_overlap : 0.0;
  packing.max_overlap = relaxed.touching > 0 ? relaxed.max_overlap : 0.0;
  packing.unbalanced = relaxed.unbalanced;
  packing.steps = relaxed.steps;
  return packing;
}

}  // namespace gabion::dem
