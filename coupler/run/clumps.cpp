#include "coupler/run/clumps.hpp"

#include <algorithm>
#include <array>
#include <cstdio>
#include <set>

#include "coupler/ground/surface.hpp"

namespace gabion::coupler {

namespace {

bool holds(const scene::Face& face) {
  return face.kind == "fixed" || face.kind == "roller" || face.kind == "seat" || face.kind == "velocity";
}

/// Whether a face is so at the start or in some stage.
template <class Is>
bool ever(const scene::Scene& scene, int face, Is is) {
  bool found = is(scene.faces[face]);
  for (const scene::Stage& stage : scene.stages)
    for (const auto& [changed, condition] : stage.faces) found = found || (changed == face && is(condition));
  return found;
}

bool may_join(const scene::Scene& scene, std::int32_t material) {
  return scene.materials[static_cast<std::size_t>(material)].clump_size > 1;
}

}  // namespace

std::optional<protocol::Clumps> clump_request(const scene::Scene& scene, const Assembly& assembly) {
  const auto joins = [&](std::int32_t material) { return may_join(scene, material); };
  if (std::none_of(assembly.material.begin(), assembly.material.end(), joins)) return std::nullopt;
  std::set<std::int32_t> single;
  for (int face = 0; face < 6; ++face) {
    if (scene.ground.periodic[face / 2]) continue;
    if (ever(scene, face, holds))
      for (const std::int32_t g : grains_at_face(face, scene.ground.box, assembly.grains)) single.insert(g);
    if (ever(scene, face, [](const scene::Face& f) { return f.kind == "absorbing"; }))
      for (const std::int32_t g : grain_patch(face, scene.ground.box, scene.ground.periodic, assembly.zone, assembly.grains).entities)
        single.insert(g);
  }
  protocol::Clumps request;
  std::vector<std::int32_t> sizes;
  for (const scene::Material& material : scene.materials) sizes.push_back(material.clump_size);
  request.clump_size = sizes;
  request.gap = assembly.bond_gap;
  request.single = std::vector<std::int32_t>(single.begin(), single.end());
  return request;
}

std::string describe_clumps(const protocol::Clumped& clumped, const scene::Scene& scene, const Assembly& assembly) {
  const auto able = static_cast<std::uint64_t>(std::count_if(assembly.material.begin(), assembly.material.end(),
                                                             [&](std::int32_t m) { return may_join(scene, m); }));
  char aspect[32];
  std::snprintf(aspect, sizeof aspect, "%.3g", clumped.aspect_ratio);
  return "clumps: " + std::to_string(clumped.clumps) + " of " + std::to_string(clumped.grains) + " grains, mean aspect ratio " + aspect +
         ", " + std::to_string(able - clumped.grains) + " grains of their materials stay single";
}

}  // namespace gabion::coupler
