#include <algorithm>
#include <cmath>

#include "coupler/scene/checks.hpp"
#include "coupler/scene/geometry.hpp"

namespace gabion::scene {

std::string Checker::found(const std::string& path) const {
  constexpr std::size_t longest = 100;
  const Json* value = find_path(document_, path);
  if (value == nullptr) value = find_path(effective_, path);
  if (value == nullptr) return "missing";
  const std::string text = value->is_string() ? quoted(*value) : value->dump();
  return text.size() <= longest ? text : text.substr(0, longest) + " ...";
}

std::string Checker::coupling_path(const std::string& key) const {
  const std::string own = "coupling." + to_string(scene.model) + "." + key;
  return given(own) ? own : "coupling." + key;
}

std::string Checker::zone_path() const {
  const std::string path = coupling_path("zone");
  return coupled() && given(path) ? path : "grains.zone";
}

namespace {

using Names = std::vector<std::string>;

const Names& rows_of(Model model) {
  static const Names bridging{"mortar", "mortar2h", "strict"}, edge{"edge", "edge_projected", "edge_hats"};
  return model == Model::edge ? edge : bridging;
}

void check_coupling(Checker& check) {
  if (!check.coupled()) return;
  const Coupling& coupling = check.scene.coupling;
  const std::string model = to_string(check.scene.model), other = model == "edge" ? "bridging" : "edge";
  const Names& known = rows_of(check.scene.model);
  const bool fits = std::find(known.begin(), known.end(), coupling.rows) != known.end();
  if (!fits)
    check.error(check.coupling_path("rows"), "one of " + listed(known) + " for model = " + model,
                "move it to coupling." + other + ".rows to keep it for model = " + other + ", or leave it out");
  const bool sponge = coupling.sponge.strength > 0.0;
  if (sponge && coupling.rows != "mortar")
    check.error(check.coupling_path("sponge"), "no sponge with rows = " + coupling.rows,
                "the sponge works with rows = mortar only; put it into coupling.bridging to keep it for that model");
  if (coupling.solve == "row_sum" && coupling.rows != "strict")
    check.error(check.coupling_path("solve"), "exact, unless rows = strict",
                "row_sum is the explicit form of the strict rows only; use solve = exact");
  if (coupling.border_weights && coupling.rows == "edge_hats")
    check.error(check.coupling_path("border_weights"), "false with rows = edge_hats",
                "hats hold only mean motion: grains whose contacts count little would hang loose; leave it out");
  if (coupling.rows == "edge_projected")
    check.warn(check.coupling_path("rows"), "edge",
               "a rotating body is turned round by edge_projected; use it only to reproduce the original method");
  if (coupling.rows == "mortar2h" && !sponge)
    check.warn(check.coupling_path("rows"), "mortar with a sponge",
               "without a sponge mortar2h reflects 43 % of waves of 4 elements");
  if (coupling.solve == "row_sum")
    check.warn(check.coupling_path("solve"), "exact", "row_sum takes energy: 1 to 19 % of a resolved wave");
}

void check_materials(Checker& check) {
  const Scene& scene = check.scene;
  for (const Material& material : scene.materials) {
    const std::string path = "materials." + material.name;
    if (check.has_mesh() && scene.mesh.stiffness == "material") {
      const auto need = [&](bool there, const std::string& key, const std::string& example) {
        if (!there)
          check.error(path + "." + key, "a value, such as " + example,
                      "mesh.stiffness = material takes young, poisson and bulk_density from the material; give them or "
                      "use 'measured'");
      };
      need(material.young.has_value(), "young", "'500 MPa'");
      need(material.poisson.has_value(), "poisson", "0.32");
      need(material.bulk_density.has_value(), "bulk_density", "'1670 kg/m3'");
    }
    const bool frozen = check.has_grains() && scene.grains.geometry == "frozen";
    const auto endless = [&](double strength, const std::string& key) {
      if (frozen && std::isfinite(strength))
        check.error(path + "." + key, "'infinite' while grains.geometry = frozen",
                    "frozen contacts cannot break: use geometry = updated, or let the strength be infinite");
    };
    endless(material.normal_strength, "normal_strength");
    endless(material.shear_strength, "shear_strength");
    if (!check.has_grains() || material.clump_size == 1) continue;
    if (frozen)
      check.error(path + ".clump_size", "1 while grains.geometry = frozen",
                  "frozen contacts know no clumps: use geometry = updated");
    if (check.coupled() && material.name == scene.ground.material)
      check.error(path + ".clump_size", "1 for the material of the ground in a coupled model",
                  "grains that share their place with the mesh stay single: put the clumps into a fill of another material, "
                  "or use model = dem");
  }
}

void check_face(Checker& check, int face, const Face& condition, const std::string& path) {
  if (check.scene.ground.periodic[face / 2] && condition.kind != "free")
    check.error(path, "'free', because the ground is periodic across this face",
                "leave the face out, or ground.periodic");
  const bool directed = condition.kind == "traction" || condition.kind == "velocity";
  const bool components = check.given(path + ".velocity[0]");
  if (components && check.given(path + ".direction"))
    check.error(path + ".direction", "no direction beside a velocity with three components", "remove one of the two");
  else if (directed && condition.direction == Point{})
    check.error(path + (components ? ".velocity" : ".direction"),
                components ? "a velocity other than 0" : "a direction, such as \"z\" or [0, 0, -1]",
                "a face at rest is 'fixed' or a 'roller'");
  const auto& p = condition.history.parameters;
  if (condition.history.kind != "table") return;
  const std::string table = path + "." + condition.kind + ".table";
  for (std::size_t i = 2; i < p.size(); i += 2)
    if (p[i] <= p[i - 2]) {
      check.error(table + "[" + std::to_string(i / 2) + "]", "a time after that of the row above",
                  "sort the rows by time");
      return;
    }
}

void check_faces(Checker& check) {
  const Scene& scene = check.scene;
  for (int face = 0; face < 6; ++face) check_face(check, face, scene.faces[face], "faces." + face_names[face]);
  for (std::size_t s = 0; s < scene.stages.size(); ++s)
    for (const auto& [face, condition] : scene.stages[s].faces)
      check_face(check, face, condition, "stages[" + std::to_string(s) + "].faces." + face_names[face]);
}

void check_stages(Checker& check) {
  const auto& stages = check.scene.stages;
  for (std::size_t i = 0; i < stages.size(); ++i) {
    const Stage& stage = stages[i];
    const std::string path = "stages[" + std::to_string(i) + "]";
    if (std::isinf(stage.duration) && stage.steps == 0 && stage.unbalanced == 0.0)
      check.error(path + ".duration", "an end of the stage '" + stage.name + "'",
                  "give one of duration (\"20 ms\"), steps (1000) or until ({\"unbalanced\": 1e-6})");
    if (stage.name.empty()) check.error(path + ".name", "a name that is not empty", "results are stored by it");
    for (std::size_t j = 0; j < i; ++j)
      if (stages[j].name == stage.name)
        check.error(path + ".name", "a name that no other stage has", "rename one of the two");
    if (stage.unbalanced > 0.0 && stage.damping == 0.0)
      check.warn(path + ".damping", "above 0 in a stage that ends at equilibrium",
                 "without damping it may never end; 0.69 is usual");
  }
}

/// Whether something keeps the ground from falling along the gravity in the first stage with gravity.
void check_gravity(Checker& check) {
  const Scene& scene = check.scene;
  for (int axis = 0; axis < 3; ++axis) {
    if (scene.gravity[axis] == 0.0) continue;
    if (scene.ground.periodic[axis]) {
      check.error("gravity[" + std::to_string(axis) + "]", "0 along a periodic direction",
                  "nothing can hold the ground there");
      continue;
    }
    Faces faces = scene.faces;
    for (const Stage& stage : scene.stages) {
      for (const auto& [face, condition] : stage.faces) faces[face] = condition;
      if (!stage.gravity) continue;
      const auto holds = [&](int face) {
        const Face& f = faces[face];
        return f.kind == "fixed" || (f.kind == "wall" && face / 2 == axis) || ((f.kind == "roller" || f.kind == "seat") && face / 2 == axis) ||
               (f.kind == "velocity" && f.direction[axis] != 0.0);
      };
      bool held = false;
      for (int face = 0; face < 6; ++face) held = held || holds(face);
      if (!held)
        check.warn("gravity", "a face that holds the ground in stage '" + stage.name + "'",
                   "make the face below a roller or fixed, or the ground falls; absorbing faces hold nothing");
      break;
    }
  }
}

void check_block(Checker& check) {
  const Scene& scene = check.scene;
  if (!scene.block) return;
  if (!check.has_grains())
    check.error("block", "no block with model = continuum",
                "the block acts on grains: use dem, bridging or edge, or --set block=null");
  if (check.has_grains() && scene.grains.geometry == "frozen")
    check.error("grains.geometry", "'updated' with a block", "frozen grains find no new contacts");
  Names names;
  for (const Stage& stage : scene.stages) names.push_back(stage.name);
  if (scene.block->stage < 0) {
    const std::string near = nearest(check.found("block.stage").substr(1), names);
    check.error("block.stage", "the name of a stage: " + listed(names),
                near.empty() ? "the last stage is the default" : "did you mean " + quoted(near) + "?");
  }
}

}  // namespace

void check_choices(Checker& check) {
  check_coupling(check);
  check_materials(check);
  check_faces(check);
  check_stages(check);
  check_gravity(check);
  check_block(check);
}

}  // namespace gabion::scene
