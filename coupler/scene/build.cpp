#include "coupler/scene/build.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "coupler/scene/geometry.hpp"

namespace gabion::scene {
namespace {

Point point(const Json& value) {
  return {value[0].get<double>(), value[1].get<double>(), value[2].get<double>()};
}

Box box(const Json& value) {
  return {point(value[0]), point(value[1])};
}

int axis_index(const std::string& name) {
  return name.back() - 'x';
}

Model model_of(const std::string& name) {
  Model model = Model::dem;
  for (const Model candidate : {Model::dem, Model::continuum, Model::bridging, Model::edge})
    if (to_string(candidate) == name) model = candidate;
  return model;
}

template <typename T>
std::optional<T> optional(const Json& parent, const char* key) {
  if (!parent.contains(key)) return std::nullopt;
  return parent[key].get<T>();
}

Material material(const std::string& name, const Json& m) {
  return {.name = name,
          .normal_stiffness = m["normal_stiffness"],
          .shear_stiffness = m["shear_stiffness"],
          .density = m["density"],
          .friction = m["friction"],
          .normal_strength = m["normal_strength"],
          .shear_strength = m["shear_strength"],
          .rolling_stiffness = m["rolling_stiffness"],
          .rolling_friction = m["rolling_friction"],
          .restitution = m["restitution"],
          .rotates = m["rotation"] == "free",
          .clump_size = m["clump_size"],
          .young = optional<double>(m, "young"),
          .poisson = optional<double>(m, "poisson"),
          .bulk_density = optional<double>(m, "bulk_density")};
}

Ground ground(const Json& g) {
  Ground result{.box = box(g["box"]), .material = g["material"]};
  for (const std::string axis : g["periodic"]) result.periodic[axis_index(axis)] = true;
  return result;
}

void set_radius(Grains& grains, const Json& radius) {
  if (radius.is_number()) {
    grains.radius = {radius};
    if (grains.packing == "random" || grains.packing == "file") grains.radius.push_back(radius);
    return;
  }
  if (radius.contains("uniform")) {
    grains.radius = radius["uniform"].get<std::vector<double>>();
    return;
  }
  grains.radius_kind = "sieve";
  for (const Json& sieve : radius["sieve"]) {
    grains.radius.push_back(sieve[0]);
    grains.radius.push_back(sieve[1]);
  }
}

Grains grains(const Json& g, const Json& coupling) {
  Grains result{.zone = {},
                .zone_to_choose = coupling.value("zone", Json()) == "auto",
                .packing = g["packing"],
                .file = g.value("file", ""),
                .bond_gap = g["bond_gap"],
                .radius = {},
                .solid_fraction = g["solid_fraction"],
                .contacts_per_grain = g["contacts_per_grain"],
                .min_contacts = g["min_contacts"],
                .seed = g["seed"],
                .rotations = g["rotations"] == "free",
                .geometry = g["geometry"]};
  if (g.contains("zone")) result.zone = box(g["zone"]);
  if (coupling.contains("zone") && !result.zone_to_choose) result.zone = box(coupling["zone"]);
  set_radius(result, g["radius"]);
  return result;
}

Rates rates(const Json& r) {
  return {.largest = r["largest"].is_number() ? r["largest"].get<int>() : 0,
          .nested = r["nested"],
          .layers = r["layers"],
          .first_layers = r["first_layers"],
          .energy_tolerance = r["energy_tolerance"]};
}

Mesh mesh(const Json& m) {
  Mesh result{.size = m["size"], .grading = m["grading"], .element = m["element"], .stiffness = m["stiffness"], .held_faces = m["held_faces"], .rates = {}};
  if (m.contains("rates")) result.rates = rates(m["rates"]);
  return result;
}

/// Radii from the border within which grains are tied. A tied layer is too stiff, for its grains cannot move against one
/// another, and a thin one too soft, for contacts across the border are lost; where both cancel depends on how much the
/// grains move against one another, hence on k_s/k_n. Measured on random packings of 5.7 contacts per grain
/// (docs/decisions.md, "Reach of the edge tie"). On a lattice the planes decide.
double default_reach(const Coupling& coupling, const Grains& grains, const Material* soil) {
  if (coupling.rows == "edge_hats") return 1.25;
  const double whole = coupling.border_weights ? 1.15 : 0.9;
  if (coupling.rows != "edge" || is_lattice(grains) || !soil || !(soil->shear_stiffness > 0.0)) return whole;
  const double ratio = std::log(soil->shear_stiffness / soil->normal_stiffness);
  return coupling.border_weights ? std::clamp(1.30 + 0.20 * ratio, 0.75, 1.3) : std::clamp(0.885 + 0.085 * ratio, 0.65, 0.9);
}

Coupling coupling(Json& values, double element_size, const Grains& grains, const Material* soil) {
  Json& c = values["coupling"];
  if (!c.contains("border_weights")) c["border_weights"] = c["rows"] == "edge";
  constexpr double default_elements = 4.0;
  if (values["model"] == "bridging" && !c.contains("overlap")) c["overlap"] = default_elements * element_size;
  Coupling result{.overlap = c.value("overlap", 0.0),
                  .rows = c["rows"],
                  .solve = c["solve"],
                  .sponge = {},
                  .weight_floor = c["weight_floor"],
                  .border_weights = values["model"] == "edge" && c["border_weights"],
                  .rotation_limit = c["rotation_limit"]};
  if (!c.contains("reach")) c["reach"] = default_reach(result, grains, soil);
  result.reach = c["reach"];
  if (c.contains("sponge")) result.sponge.strength = c["sponge"]["strength"];
  return result;
}

History history(const Json& value) {
  if (value.is_number()) return {"constant", {value}};
  if (value.contains("half_sine")) {
    const Json& pulse = value["half_sine"];
    return {"half_sine", {pulse["amplitude"], pulse["start"], pulse["duration"]}};
  }
  if (value.contains("ramp")) {
    const Json& ramp = value["ramp"];
    return {"ramp", {ramp["value"], ramp["start"], ramp["rise"]}};
  }
  History table{"table", {}};
  for (const Json& row : value["table"]) table.parameters.insert(table.parameters.end(), {row[0], row[1]});
  return table;
}

/// Half-sine velocity whose integral is the distance: amplitude = pi by / (2 over).
History displacement(const Json& move) {
  const double by = move["by"], over = move["over"];
  return {"half_sine", {std::numbers::pi * by / (2 * over), move["start"], over}};
}

double length(const Point& v) {
  return std::hypot(v[0], v[1], v[2]);
}

Point direction(const Json& value) {
  Point d{};
  if (value.is_string()) {
    const std::string name = value;
    d[axis_index(name)] = name.front() == '-' ? -1.0 : 1.0;
    return d;
  }
  d = point(value);
  const double norm = length(d);
  if (norm > 0.0)
    for (double& component : d) component /= norm;
  return d;
}

Face face(const Json& value) {
  if (value.is_string()) return {.kind = value, .history = {}};
  if (value.contains("wall")) {
    Face wall{.kind = "wall", .history = {}};
    wall.friction = value["wall"]["friction"];
    return wall;
  }
  const Point along = value.contains("direction") ? direction(value["direction"]) : Point{};
  if (value.contains("pressure")) return {"pressure", history(value["pressure"]), {}};
  if (value.contains("traction")) return {"traction", history(value["traction"]), along};
  if (value.contains("displace")) return {"velocity", displacement(value["displace"]), along};
  const Json& velocity = value["velocity"];
  if (!velocity.is_array()) return {"velocity", history(velocity), along};
  return {"velocity", {"constant", {length(point(velocity))}}, direction(velocity)};
}

Block block(Json& b, const std::vector<Stage>& stages) {
  Block result{.shape = b["shape"],
               .side = b["side"],
               .mass = b["mass"],
               .tip = b["tip"],
               .spin = point(b["spin"]),
               .rotation = b["rotation"] == "free",
               .friction = b["friction"],
               .touching = b["position"].size() == 2};
  for (std::size_t i = 0; i < b["position"].size(); ++i) result.position[i] = b["position"][i];
  if (b["velocity"].is_array())
    result.velocity = point(b["velocity"]);
  else
    result.velocity[2] = -b["velocity"].get<double>();
  if (!b.contains("stage")) b["stage"] = stages.back().name;
  result.stage = -1;  // unknown name: told by the checks
  for (std::size_t i = 0; i < stages.size(); ++i)
    if (stages[i].name == b["stage"]) result.stage = static_cast<int>(i);
  return result;
}

Stage stage(Json& s) {
  Stage result{.name = s["name"],
               .damping = s["damping"],
               .duration = s.value("duration", infinity),
               .steps = s.value("steps", std::uint64_t{0}),
               .unbalanced = s.contains("until") ? s["until"]["unbalanced"].get<double>() : 0.0,
               .max_steps = s["max_steps"],
               .faces = {},
               .gravity = s["gravity"],
               .zero_displacements = s["zero_displacements"]};
  double end = 0.0;
  for (int f = 0; f < 6; ++f) {
    if (!s["faces"].contains(face_names[f])) continue;
    result.faces.emplace_back(f, face(s["faces"][face_names[f]]));
    end = std::max(end, end_of(result.faces.back().second.history));
  }
  if (!s.contains("at_least")) s["at_least"] = end;
  result.at_least = s["at_least"];
  return result;
}

Wave wave(const Json& w) {
  return {.axis = axis_index(w["axis"]),
          .polarisation = axis_index(w["polarisation"]),
          .wavelength = w["wavelength"],
          .centre = w["centre"],
          .width = w["width"],
          .amplitude = w["amplitude"],
          .sense = w["sense"] == "+" ? 1.0 : -1.0,
          .speed = w["speed"]};
}

InitialMotion initial_motion(const Json& i) {
  InitialMotion motion;
  for (std::size_t k = 0; k < 6; ++k) motion.strain[k] = i["strain"][k];
  motion.rotation = point(i["rotation"]);
  motion.translation = point(i["translation"]);
  motion.velocity = point(i["velocity"]);
  motion.noise = i["noise"];
  motion.noise_seed = i["noise_seed"];
  motion.state = i.value("state", "");
  return motion;
}

Output output(const Json& o) {
  return {.every = o["every"],
          .probe_every = o["probe_every"],
          .monitor_steps = o["monitor_steps"],
          .fields = o["fields"].get<std::vector<std::string>>()};
}

Run run(const Json& r) {
  const Json& threads = r["threads"];
  return {.step_fraction = r["step_fraction"],
          .step = optional<double>(r, "step"),
          .threads_dem = threads.is_object() ? threads["dem"].get<int>() : threads.get<int>(),
          .threads_continuum = threads.is_object() ? threads["continuum"].get<int>() : threads.get<int>(),
          .checkpoint_every = r["checkpoint_every"],
          .energy_tolerance = r["energy_tolerance"],
          .measure_energy = r["measure_energy"]};
}

Laboratory laboratory(const Json& l) {
  return {.confinements = l["confinements"].get<std::vector<double>>(),
          .axial_strain = l["axial_strain"],
          .peak_strain = l["peak_strain"],
          .peak_inertial_number = l["peak_inertial_number"],
          .inertial_number = l["inertial_number"],
          .damping = l["damping"],
          .unbalanced = l["unbalanced"],
          .max_steps = l["max_steps"]};
}

}  // namespace

bool InitialMotion::any() const {
  const auto nonzero = [](double value) { return value != 0.0; };
  return std::any_of(strain.begin(), strain.end(), nonzero) || std::any_of(rotation.begin(), rotation.end(), nonzero) ||
         std::any_of(translation.begin(), translation.end(), nonzero) ||
         std::any_of(velocity.begin(), velocity.end(), nonzero) || noise != 0.0 || !state.empty();
}

Scene build_scene(Json& v, const std::string& name) {
  Scene scene;
  scene.title = v["title"];
  scene.name = name;
  scene.model = model_of(v["model"]);
  scene.gravity = point(v["gravity"]);
  scene.ground = ground(v["ground"]);
  for (const Json& fill : v["fills"]) scene.fills.push_back({box(fill["box"]), fill["material"]});
  for (const auto& [key, value] : v["materials"].items()) scene.materials.push_back(material(key, value));
  const bool coupled = scene.model == Model::bridging || scene.model == Model::edge;
  if (v.contains("mesh")) scene.mesh = mesh(v["mesh"]);
  if (v.contains("grains")) scene.grains = grains(v["grains"], coupled ? v["coupling"] : Json::object());
  const auto soil = std::find_if(scene.materials.begin(), scene.materials.end(),
                                 [&](const Material& m) { return m.name == scene.ground.material; });
  if (coupled) scene.coupling = coupling(v, scene.mesh.size, scene.grains, soil == scene.materials.end() ? nullptr : &*soil);
  for (int f = 0; f < 6; ++f) scene.faces[f] = face(v["faces"][face_names[f]]);
  for (Json& s : v["stages"]) scene.stages.push_back(stage(s));
  if (v.contains("block")) scene.block = block(v["block"], scene.stages);
  if (v["initial"].contains("wave")) scene.wave = wave(v["initial"]["wave"]);
  scene.initial = initial_motion(v["initial"]);
  for (const Json& probe : v["probes"]) scene.probes.push_back({probe["name"], point(probe["at"])});
  scene.output = output(v["output"]);
  scene.run = run(v["run"]);
  if (v.contains("laboratory")) scene.laboratory = laboratory(v["laboratory"]);
  return scene;
}

}  // namespace gabion::scene
