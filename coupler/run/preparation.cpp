#include "coupler/run/preparation.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <fstream>
#include <optional>
#include <random>
#include <stdexcept>

#include "coupler/ground/loose_grains.hpp"
#include "coupler/results/earlier_state.hpp"
#include "coupler/scene/origin.hpp"
#include "coupler/scene/packing_file.hpp"
#include "coupler/run/clumps.hpp"
#include "coupler/run/run_failed.hpp"
#include "protocol/engine/hash.hpp"

namespace gabion::coupler {

namespace {

/// Changes when what a cached file depends on changes in meaning.
constexpr std::uint64_t cache_version = 1;
/// Of the load cases that give a packing's stiffness: their figures are then good to this share.
constexpr double largest_homogenisation_residual = 1e-3;

std::vector<double> flatten(const std::vector<Point>& points) {
  std::vector<double> flat;
  flat.reserve(3 * points.size());
  for (const Point& p : points) flat.insert(flat.end(), p.begin(), p.end());
  return flat;
}

std::vector<double> flatten(const Point& p) { return {p.begin(), p.end()}; }

void add(engine::Hash& hash, const std::vector<double>& values) {
  hash.add(static_cast<std::uint64_t>(values.size()));
  for (const double v : values) hash.add(v);
}

protocol::Options options_of(const scene::Scene& scene) {
  protocol::Options options;
  options.gravity = flatten(scene.gravity);
  options.box_lo = flatten(scene.ground.box.lo);
  options.box_hi = flatten(scene.ground.box.hi);
  options.periodic = std::vector<std::uint8_t>{scene.ground.periodic[0], scene.ground.periodic[1], scene.ground.periodic[2]};
  options.measure_energy = scene.run.measure_energy;
  return options;
}

protocol::GrainMaterials grain_materials(const std::vector<scene::Material>& materials) {
  protocol::GrainMaterials m;
  for (const scene::Material& material : materials) {
    m.normal_stiffness.data.push_back(material.normal_stiffness);
    m.shear_stiffness.data.push_back(material.shear_stiffness);
    m.density.data.push_back(material.density);
    m.friction.data.push_back(material.friction);
    m.normal_strength.data.push_back(material.normal_strength);
    m.shear_strength.data.push_back(material.shear_strength);
    m.rolling_stiffness.data.push_back(material.rolling_stiffness);
    m.rolling_friction.data.push_back(material.rolling_friction);
    m.restitution.data.push_back(material.restitution);
    m.rotation.data.push_back(material.rotates ? 1 : 0);
  }
  for (auto* field : {&m.normal_stiffness, &m.shear_stiffness, &m.density, &m.friction, &m.normal_strength, &m.shear_strength,
                      &m.rolling_stiffness, &m.rolling_friction, &m.restitution})
    field->set_shape(std::array<std::uint64_t, 1>{field->data.size()});
  m.rotation.set_shape(std::array<std::uint64_t, 1>{m.rotation.data.size()});
  return m;
}

protocol::ContactOptions contact_options(const scene::Scene& scene) {
  protocol::ContactOptions options;
  options.geometry = scene.grains.geometry;
  options.rotations = scene.grains.rotations ? 1 : 0;
  return options;
}

void send_weights(const Assembly& assembly, EngineLink& link) {
  if (!assembly.coupled()) return;
  protocol::Weights weights;
  weights.outer_lo = flatten(assembly.zone.outer().lo);
  weights.outer_hi = flatten(assembly.zone.outer().hi);
  weights.width = assembly.zone.overlap();
  weights.floor = assembly.zone.weight_floor();
  link.tell(weights);
}

}  // namespace

namespace {

/// Grains as a file gives them; all of them stay.
Packing read_packing(const scene::Scene& scene) {
  const scene::PackingFile file = scene::read_packing_file(scene.grains.file);
  Packing packing;
  for (const Point& x : file.position) {
    Point& local = packing.position.emplace_back();
    for (int axis = 0; axis < 3; ++axis) local[axis] = scene::local_coordinate(x[axis], scene.origin[axis]);
  }
  packing.radius = file.radius;
  packing.gap = scene.grains.bond_gap;
  const double grains = static_cast<double>(packing.radius.size());
  packing.contacts_per_grain = 2.0 * static_cast<double>(contact_pairs(packing, scene.ground).size()) / grains;
  double volume = 1.0, solid = 0.0;
  for (int axis = 0; axis < 3; ++axis) volume *= scene.ground.box.hi[axis] - scene.ground.box.lo[axis];
  for (const double r : packing.radius) solid += 4.0 / 3.0 * std::acos(-1.0) * r * r * r;
  packing.solid_fraction = solid / volume;
  return packing;
}

}  // namespace

Packing obtain_packing(const scene::Scene& scene, EngineLink* dem, const Cache& cache, const Log& log) {
  if (scene::is_lattice(scene.grains)) return make_lattice(scene);
  if (scene.grains.packing == "file") return read_packing(scene);
  protocol::Pack pack;
  pack.box_lo = flatten(scene.ground.box.lo);
  pack.box_hi = flatten(scene.ground.box.hi);
  pack.periodic = std::vector<std::uint8_t>{scene.ground.periodic[0], scene.ground.periodic[1], scene.ground.periodic[2]};
  pack.radius_kind = scene.grains.radius_kind;
  pack.radius = scene.grains.radius;
  pack.solid_fraction = scene.grains.solid_fraction;
  pack.contacts_per_grain = scene.grains.contacts_per_grain;
  pack.min_contacts = scene.grains.min_contacts;
  pack.seed = scene.grains.seed;
  engine::Hash key;
  key.add(cache_version);
  std::vector<std::byte> bytes;
  protocol::Writer writer(bytes);
  pack.encode(writer);
  for (const std::byte b : bytes) key.add(static_cast<std::uint64_t>(b));
  const auto path = cache.file("packing", key.value());
  std::optional<protocol::Packed> packed = read_cached<protocol::Packed>(path);
  if (packed) {
    log("packing: from the cache");
  } else {
    if (!dem) throw protocol::AddressError("the packing is not in the cache: a dem_server is needed to make it (--dem)");
    log("packing: making it");
    packed = dem->ask<protocol::Packed>(pack);
    write_cached(path, *packed);
  }
  Packing packing;
  for (std::size_t i = 0; i < packed->radius.size(); ++i) {
    packing.position.push_back({packed->position[3 * i], packed->position[3 * i + 1], packed->position[3 * i + 2]});
    packing.radius.push_back(packed->radius[i]);
  }
  packing.gap = packed->gap;
  packing.contacts_per_grain = packed->contacts_per_grain;
  packing.solid_fraction = packed->solid_fraction;
  packing.residual_overlap = packed->residual_overlap;
  packing.rattlers = packed->rattlers;
  return packing;
}

namespace {

constexpr int lattice_sample_cells = 3;

/// A lattice repeats: a few cells, periodic in every direction, have its stiffness to round-off.
scene::Scene lattice_sample(const scene::Scene& scene, const Packing& lattice) {
  scene::Scene sample = scene;
  const double cell = lattice.radius[0] * (scene.grains.packing == "fcc" ? 2.0 * std::sqrt(2.0) : 2.0);
  sample.ground.periodic = {true, true, true};
  sample.ground.box.lo = {0, 0, 0};
  sample.ground.box.hi = {lattice_sample_cells * cell, lattice_sample_cells * cell, lattice_sample_cells * cell};
  sample.grains.zone.reset();
  sample.grains.radius = {lattice.radius[0]};
  return sample;
}

}  // namespace

void tell_bonded_packing(const scene::Scene& scene, const Packing& packing, EngineLink& dem) {
  protocol::Options options = options_of(scene);
  options.gravity = std::vector<double>{0, 0, 0};
  dem.tell(options);
  scene::Material elastic = scene.material(scene.ground.material);  // strengths do not matter at unit strain
  elastic.friction = elastic.normal_strength = elastic.shear_strength = scene::infinity;
  dem.tell(grain_materials({elastic}));
  protocol::ContactOptions contacts = contact_options(scene);
  contacts.geometry = "frozen";
  dem.tell(contacts);
  protocol::Grains grains;
  grains.position = flatten(packing.position);
  grains.radius = packing.radius;
  grains.material = std::vector<std::int32_t>(packing.radius.size(), 0);
  dem.tell(grains);
  protocol::Bonds bonds;
  bonds.gap = packing.gap;
  dem.ask<protocol::Bonded>(bonds);
  dem.ask<protocol::Ready>(protocol::Prepare{});
}

Elasticity obtain_elasticity(const scene::Scene& whole, const Packing& whole_packing, EngineLink* dem, const Cache& cache,
                             const Log& log) {
  const bool lattice = scene::is_lattice(whole.grains);
  const scene::Scene scene = lattice ? lattice_sample(whole, whole_packing) : whole;
  const Packing packing = lattice ? make_lattice(scene) : whole_packing;
  const scene::Material& soil = scene.material(scene.ground.material);
  if (scene.mesh.stiffness == "material") {
    if (!soil.young || !soil.poisson || !soil.bulk_density)
      throw std::runtime_error("mesh.stiffness is 'material', but material '" + soil.name +
                               "' lacks young, poisson or bulk_density; give them or use 'measured'");
    return {isotropic_stiffness(*soil.young, *soil.poisson), *soil.bulk_density};
  }
  const Box window = homogenisation_window(scene, packing);
  engine::Hash key;
  key.add(cache_version);
  add(key, flatten(packing.position));
  add(key, packing.radius);
  const bool rotating = scene.grains.rotations && soil.rotates;
  // not 0: under it older programs kept answers in which grains rotated all the same
  add(key, {packing.gap, soil.normal_stiffness, soil.shear_stiffness, soil.density, rotating ? 1.0 : -1.0});
  add(key, flatten(window.lo));
  add(key, flatten(window.hi));
  add(key, flatten(scene.ground.box.lo));
  add(key, flatten(scene.ground.box.hi));
  add(key, {1.0 * scene.ground.periodic[0], 1.0 * scene.ground.periodic[1], 1.0 * scene.ground.periodic[2]});
  const auto path = cache.file("stiffness", key.value());
  std::optional<protocol::Homogenised> measured = read_cached<protocol::Homogenised>(path);
  if (measured) {
    log("stiffness of the packing: from the cache");
  } else {
    if (!dem) throw protocol::AddressError("the stiffness of the packing is not in the cache: a dem_server is needed to measure it (--dem)");
    log("stiffness of the packing: measuring it");
    tell_bonded_packing(scene, packing, *dem);
    protocol::Homogenise homogenise;
    homogenise.box_lo = flatten(window.lo);
    homogenise.box_hi = flatten(window.hi);
    measured = dem->ask<protocol::Homogenised>(homogenise);
    if (!(measured->residual <= largest_homogenisation_residual))
      throw std::runtime_error("mesh.stiffness: the packing's stiffness could not be measured, the load cases have a residual of " +
                               std::to_string(measured->residual) + "; grains that nothing holds? Raise grains.contacts_per_grain, or give young, "
                               "poisson and bulk_density and use mesh.stiffness = material");
    write_cached(path, *measured);
  }
  Elasticity elasticity;
  for (int i = 0; i < 6; ++i)
    for (int j = 0; j < 6; ++j) elasticity.stiffness[i][j] = measured->stiffness[static_cast<std::size_t>(6 * i + j)];
  elasticity.density = measured->density;
  if (scene.mesh.stiffness == "measured_isotropic") {
    const IsotropicFit fit = isotropic_fit(elasticity.stiffness);
    elasticity.stiffness = isotropic_stiffness(fit.young, fit.poisson);
  }
  if (!lattice) elasticity.face_offset = obtain_face_offsets(scene, packing, dem, cache, log);
  return elasticity;
}

namespace {

/// Multipliers divide by these: one that is no number would be found steps later, and somewhere else.
void check_masses(const protocol::Ready& ready, const std::string& engine, const std::string& entity, std::size_t count) {
  for (const auto* masses : {&ready.mass, &ready.plain_mass}) {
    if (masses->size() != count)
      throw std::runtime_error(engine + " answered PREPARE with " + std::to_string(masses->size()) + " masses for " +
                               std::to_string(count) + " " + entity + "s");
    for (std::size_t i = 0; i < count; ++i)
      if (!((*masses)[i] > 0.0) || !std::isfinite((*masses)[i]))
        throw RunFailed(engine + " gives " + entity + " " + std::to_string(i) + " the mass " + std::to_string((*masses)[i]) +
                        " kg; expected a finite number above 0");
  }
}

}  // namespace

protocol::Ready configure_dem(const scene::Scene& scene, Assembly& assembly, EngineLink& dem, const Log& log) {
  dem.tell(options_of(scene));
  dem.tell(grain_materials(scene.materials));
  dem.tell(contact_options(scene));
  protocol::Grains grains;
  grains.position = flatten(assembly.grains.position);
  grains.radius = assembly.grains.radius;
  grains.material = assembly.material;
  dem.tell(grains);
  if (assembly.zone.overlap() > 0.0 || scene.coupling.border_weights) send_weights(assembly, dem);
  const std::optional<protocol::Clumps> clumps = clump_request(scene, assembly);
  if (clumps) log(describe_clumps(dem.ask<protocol::Clumped>(*clumps), scene, assembly));
  protocol::Bonds bonds;
  bonds.gap = assembly.bond_gap;
  dem.ask<protocol::Bonded>(bonds);
  protocol::Ready ready = dem.ask<protocol::Ready>(protocol::Prepare{});
  check_masses(ready, "dem_server", "grain", assembly.grains.position.size());
  assembly.grains.plain_mass = ready.plain_mass.data;
  if (clumps) {
    const std::vector<double> numbers = dem.fetch("clump");
    assembly.clump.assign(numbers.begin(), numbers.end());
  }
  return ready;
}

protocol::Ready configure_continuum(const scene::Scene& scene, const Assembly& assembly, EngineLink& continuum) {
  continuum.tell(options_of(scene));
  protocol::SolidMaterials materials;
  for (const auto& share : assembly.layers.share)
    for (const auto& row : layer_stiffness(assembly.elasticity.stiffness, share))
      materials.stiffness.data.insert(materials.stiffness.data.end(), row.begin(), row.end());
  materials.stiffness.set_shape(std::array<std::uint64_t, 3>{assembly.layers.share.size(), 6, 6});
  materials.density = std::vector<double>(assembly.layers.share.size(), assembly.elasticity.density);
  continuum.tell(materials);
  protocol::Mesh mesh;
  mesh.nodes = flatten(assembly.mesh.nodes);
  for (const auto& element : assembly.mesh.elements)
    mesh.elements.data.insert(mesh.elements.data.end(), element.begin(), element.end());
  for (const auto& wrap : assembly.mesh.wrap) mesh.wrap.data.insert(mesh.wrap.data.end(), wrap.begin(), wrap.end());
  mesh.elements.set_shape(std::array<std::uint64_t, 2>{assembly.mesh.elements.size(), 8});
  mesh.wrap.set_shape(std::array<std::uint64_t, 2>{assembly.mesh.wrap.size(), 8});
  mesh.material = assembly.layers.material;
  continuum.tell(mesh);
  if (assembly.zone.overlap() > 0.0) send_weights(assembly, continuum);
  protocol::Ready ready = continuum.ask<protocol::Ready>(protocol::Prepare{});
  check_masses(ready, "continuum_server", "node", assembly.mesh.nodes.size());
  return ready;
}

namespace {

/// Displacement and velocity of one point, added to what is there; rate: its step over that of the run.
using Start = std::function<void(const Point& x, double rate, double* displacement, double* velocity)>;

Start wave_start(const scene::Scene& scene, const Assembly& assembly, double dt) {
  const scene::Wave wave = *scene.wave;
  const Stiffness& c = assembly.elasticity.stiffness;
  const double modulus = wave.axis == wave.polarisation ? p_modulus(c, wave.axis) : s_modulus(c, wave.axis);
  const double speed = wave.sense * (wave.speed > 0.0 ? wave.speed : std::sqrt(modulus / assembly.elasticity.density));
  const double k = 2.0 * std::acos(-1.0) / wave.wavelength;
  // u = a cos(k s) exp(-s^2/(2 W^2)), s = x - centre - speed t
  return [=](const Point& x, double rate, double* displacement, double* velocity) {
    const double square = wave.width * wave.width;
    const double s = x[wave.axis] - wave.centre, back = s + 0.5 * speed * (rate * dt);
    displacement[wave.polarisation] += wave.amplitude * std::cos(k * s) * std::exp(-s * s / (2 * square));
    velocity[wave.polarisation] += speed * wave.amplitude * std::exp(-back * back / (2 * square)) *
                                   (k * std::sin(k * back) + back / square * std::cos(k * back));
  };
}

Start motion_start(const scene::Scene& scene) {
  const scene::InitialMotion motion = scene.initial;
  Point centre;
  for (int axis = 0; axis < 3; ++axis) centre[axis] = 0.5 * (scene.ground.box.lo[axis] + scene.ground.box.hi[axis]);
  return [=, random = std::mt19937_64(motion.noise_seed)](const Point& x, double, double* u, double* v) mutable {
    const auto& e = motion.strain;
    const double gradient[3][3] = {{e[0], 0.5 * e[5], 0.5 * e[4]}, {0.5 * e[5], e[1], 0.5 * e[3]}, {0.5 * e[4], 0.5 * e[3], e[2]}};
    const Point r{x[0] - centre[0], x[1] - centre[1], x[2] - centre[2]};
    for (int i = 0; i < 3; ++i) {
      const int j = (i + 1) % 3, k = (i + 2) % 3;
      u[i] += motion.translation[i] + motion.rotation[j] * r[k] - motion.rotation[k] * r[j];
      for (int m = 0; m < 3; ++m) u[i] += gradient[i][m] * r[m];
      const double share = static_cast<double>(random() >> 11) * 0x1.0p-53;
      v[i] += motion.velocity[i] + motion.noise * (2.0 * share - 1.0);
    }
  };
}

void put_field(EngineLink& link, const char* name, const std::vector<double>& values) {
  protocol::SetField field;
  field.field = name;
  field.values.set_shape(std::array<std::uint64_t, 2>{values.size() / 3, 3});
  field.values.data = values;
  link.tell(field);
}

void put(EngineLink* link, const std::vector<Point>& points, Start start, const std::function<double(std::size_t)>& rate) {
  if (!link) return;
  std::vector<double> displacement(3 * points.size(), 0.0), velocity(3 * points.size(), 0.0);
  for (std::size_t i = 0; i < points.size(); ++i) start(points[i], rate(i), &displacement[3 * i], &velocity[3 * i]);
  put_field(*link, "displacement", displacement);
  put_field(*link, "velocity", velocity);
}

}  // namespace

void start_motion(const scene::Scene& scene, const Assembly& assembly, double dt, EngineLink* dem, EngineLink* continuum,
                  const std::function<double(std::size_t)>& node_rate) {
  if (!scene.wave && !scene.initial.any()) return;
  std::vector<Start> starts;
  if (scene.wave) starts.push_back(wave_start(scene, assembly, dt));
  if (scene.initial.any()) starts.push_back(motion_start(scene));
  const Start all = [&](const Point& x, double rate, double* u, double* v) {
    for (Start& start : starts) start(x, rate, u, v);
  };
  put(dem, assembly.grains.position, all, [](std::size_t) { return 1.0; });
  put(continuum, assembly.mesh.nodes, all, node_rate);
  if (!dem) return;
  std::vector<double> turned;  // grains turn with the rigid rotation
  for (std::size_t i = 0; i < assembly.grains.position.size(); ++i)
    turned.insert(turned.end(), scene.initial.rotation.begin(), scene.initial.rotation.end());
  if (!scene.initial.state.empty()) {
    EarlierState earlier = read_earlier_state(scene.initial.state, assembly.origin);
    put_field(*dem, "displacement", earlier.displacement);
    if (!earlier.rotation.empty()) turned = std::move(earlier.rotation);
  }
  if (scene.grains.rotations) put_field(*dem, "rotation", turned);
}

void trim_gravity(const scene::Scene& scene, const Assembly& assembly, const std::vector<double>& grain_weights, EngineLink& dem) {
  protocol::Loads loads;
  loads.name = "border gravity";
  loads.history_kind = "constant";
  loads.history = std::vector<double>{1.0};
  std::vector<double> vectors;
  for (std::size_t i = 0; i < assembly.grains.position.size(); ++i) {
    const double beyond = assembly.zone.beyond_outer(assembly.grains.position[i]);  // share by planes, as q_i
    const double inside = std::clamp(0.5 - beyond / (2.0 * assembly.grains.radius[i]), 0.0, 1.0);
    const double missing = inside - grain_weights[i];  // the engine weighs the grain with its weighted mass
    if (missing == 0.0) continue;
    loads.entities.data.push_back(static_cast<std::int32_t>(i));
    for (int axis = 0; axis < 3; ++axis) vectors.push_back(missing * assembly.grains.plain_mass[i] * scene.gravity[axis]);
  }
  loads.entities.set_shape(std::array<std::uint64_t, 1>{loads.entities.size()});
  loads.vectors = vectors;
  dem.tell(loads);
}

}  // namespace gabion::coupler
