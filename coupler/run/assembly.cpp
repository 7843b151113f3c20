#include "coupler/run/assembly.hpp"

#include <algorithm>
#include <cmath>

namespace gabion::coupler {

using scene::Model;

bool uses_grains(Model model) { return model != Model::continuum; }
bool uses_mesh(Model model) { return model != Model::dem; }

namespace {

bool absorbs(const scene::Scene& scene) {
  const auto absorbing = [](const scene::Face& face) { return face.kind == "absorbing"; };
  if (std::any_of(scene.faces.begin(), scene.faces.end(), absorbing)) return true;
  for (const scene::Stage& stage : scene.stages)
    for (const auto& [face, condition] : stage.faces)
      if (absorbing(condition)) return true;
  return false;
}

}  // namespace

bool needs_elasticity(const scene::Scene& scene) {
  return uses_mesh(scene.model) || absorbs(scene) || (scene.wave && scene.wave->speed == 0.0);
}

Assembly assemble(const scene::Scene& scene, const Packing& packing, const Elasticity& elasticity) {
  Assembly a;
  a.has_grains = uses_grains(scene.model);
  a.has_mesh = uses_mesh(scene.model);
  a.elasticity = elasticity;
  const bool edge = scene.model == Model::edge;
  if (a.has_grains && a.has_mesh)
    a.zone = Zone(scene.ground.box, scene.grains.zone.value_or(scene.ground.box), edge ? 0.0 : scene.coupling.overlap,
                  scene.coupling.weight_floor);
  else
    a.zone = Zone(scene.ground.box, scene.ground.box, 0.0, 0.0);
  if (a.has_mesh) {
    a.mesh = make_mesh(make_grid(scene, a.zone), a.zone, scene.mesh.rates);
    a.layers = face_layers(a.mesh, elasticity.face_offset);
  }
  if (a.has_grains) {
    a.bond_gap = packing.gap;
    a.origin = select_grains(packing, scene.ground, a.zone,
                             {.edge = edge, .reach = scene.coupling.reach, .slaved = scene.coupling.rows == "strict",
                              .min_contacts = scene.grains.min_contacts});
    for (const std::int32_t g : a.origin) {
      a.grains.position.push_back(packing.position[g]);
      a.grains.radius.push_back(packing.radius[g]);
      a.material.push_back(material_at(scene, packing.position[g]));
    }
  }
  return a;
}

Box homogenisation_window(const scene::Scene& scene, const Packing& packing) {
  Box window = scene.ground.box;
  const double margin = 2.0 * packing.mean_diameter();
  const bool halved = scene.grains.zone && uses_mesh(scene.model);
  // the mesh stands for the grains beyond the middle of the overlap: measure those
  const double shared = scene.model == Model::bridging ? 0.5 * scene.coupling.overlap : 0.0;
  for (int axis = 0; axis < 3; ++axis) {
    const double lo = scene.ground.box.lo[axis], hi = scene.ground.box.hi[axis];
    if (!scene.ground.periodic[axis]) {
      const double inset = std::min(margin, 0.2 * (hi - lo));
      window.lo[axis] += inset;
      window.hi[axis] -= inset;
    }
    if (!halved) continue;
    // a zone that leaves only one side of the ground to the continuum: measure there
    const double zone_lo = scene.grains.zone->lo[axis], zone_hi = scene.grains.zone->hi[axis];
    const double below = zone_lo - lo, above = hi - zone_hi;
    if (below > 3.0 * margin && above <= 0.0) window.hi[axis] = zone_lo + shared;
    if (above > 3.0 * margin && below <= 0.0) window.lo[axis] = zone_hi - shared;
  }
  return window;
}

}  // namespace gabion::coupler
