// DemEngine: from what was set to contacts, masses and the stable step.

#include <xmmintrin.h>

#include <algorithm>
#include <cmath>
#include <string>

#include "dem_server/engine.hpp"
#include "dem_server/restitution.hpp"
#include "dem_server/stable_step.hpp"
#include "protocol/engine/hash.hpp"

namespace gabion::dem {
namespace {

using engine::RequestError;

/// Share of the mean radius. Results do not depend on it; this one is fastest where grains flow.
constexpr double default_skin = 0.3;
/// Largest overlap of unbonded grains at the start, share of the smaller radius.
constexpr double largest_overlap = 0.1;
/// Pairs with a gap below this share of the mean radius count as touching when the stable step is found.
constexpr double near_gap = 0.025;

std::string grain_name(std::size_t i) {
  return "grain " + std::to_string(i);
}

/// find_pairs, with its complaints turned into the engine's.
std::vector<Pair> pairs_of(const VecField& x, const std::vector<double>& radii, double margin, const Domain& domain) {
  try {
    return find_pairs(x, radii, margin, domain);
  } catch (const std::invalid_argument& error) {
    throw RequestError("GRAINS position", error.what(), "check positions, radii and the periodic box");
  }
}

/// Denormal numbers ahead of a wave would slow the kernels down many times.
void flush_denormals(int threads) {
  constexpr unsigned flush_to_zero = 0x8000, denormals_are_zero = 0x0040;
#pragma omp parallel num_threads(threads)
  _mm_setcsr(_mm_getcsr() | flush_to_zero | denormals_are_zero);
}

bool same(const Vec a, const Vec b) {
  return a[0] == b[0] && a[1] == b[1] && a[2] == b[2];
}

}  // namespace

void DemEngine::set_grains(VecField position, std::vector<double> radius, std::vector<std::int32_t> material) {
  if (position.size() != radius.size() || position.size() != material.size())
    throw RequestError("GRAINS",
                       "position, radius and material have different lengths: " + std::to_string(position.size()) +
                           ", " + std::to_string(radius.size()) + ", " + std::to_string(material.size()),
                       "send one of each per grain");
  for (std::size_t i = 0; i < radius.size(); ++i) {
    if (!(radius[i] > 0.0) || !std::isfinite(radius[i]))
      throw RequestError("GRAINS radius", grain_name(i) + " has radius " + std::to_string(radius[i]),
                         "radii must be above 0");
    if (!std::isfinite(sum(position[i])))
      throw RequestError("GRAINS position", grain_name(i) + " has a position that is not finite", "check the packing");
    position[i][3] = 0.0;
  }
  motion.resize(position.size(), options.measure_energy);
  rotation_.resize(position.size());
  motion.position = std::move(position);
  grains_.radius = std::move(radius);
  grains_.material = std::move(material);
  bonds_.clear();
  clumps_.clear();
  built_ = false;
  boundary = {};
  tie.clear();
  probes = {};
  sponge_ = {};
  walls_.contacts.clear();
  block_.contacts.clear();
}

void DemEngine::set_materials(std::vector<GrainMaterial> materials) {
  for (std::size_t m = 0; m < materials.size(); ++m) {
    const GrainMaterial& g = materials[m];
    const bool sound = g.normal_stiffness > 0.0 && std::isfinite(g.normal_stiffness) && g.shear_stiffness >= 0.0 &&
                       std::isfinite(g.shear_stiffness) && g.density > 0.0 && std::isfinite(g.density) &&
                       g.friction >= 0.0 && g.normal_strength >= 0.0 && g.shear_strength >= 0.0 &&
                       g.rolling_stiffness >= 0.0 && std::isfinite(g.rolling_stiffness) && g.rolling_friction >= 0.0 &&
                       g.restitution > 0.0 && g.restitution <= 1.0;
    if (!sound)
      throw RequestError("GRAIN_MATERIALS", "material " + std::to_string(m) + " has a value out of range",
                         "normal stiffness and density must be above 0, restitution above 0 and at most 1, the others "
                         "at least 0; friction, rolling friction and strengths may be infinite");
  }
  for (GrainMaterial& m : materials) m.damping_ratio = damping_ratio(m.restitution);
  grains_.materials = std::move(materials);
  built_ = false;
}

void DemEngine::set_contact_options(const ContactOptions& contact_options) {
  if (!(contact_options.skin >= 0.0) || !std::isfinite(contact_options.skin))
    throw RequestError("CONTACT_OPTIONS skin", "skin is " + std::to_string(contact_options.skin),
                       "give a margin of at least 0, or 0 for the default");
  contact_options_ = contact_options;
  built_ = false;
}

Bonded DemEngine::make_bonds(double gap) {
  if (!(gap >= 0.0) || gap > 1.0)
    throw RequestError("BONDS gap", "gap is " + std::to_string(gap), "give 0 to 1 times the sum of the radii");
  const double largest = grains_.size() == 0 ? 0.0 : *std::max_element(grains_.radius.begin(), grains_.radius.end());
  // touching pairs are exact in no packing: round-off of positions must not cut them
  constexpr double slack = 1e-9;
  const double reach = gap + slack;
  bonds_ = pairs_of(motion.position, grains_.radius, 2.0 * reach * largest, domain());
  const Domain box = domain();
  std::erase_if(bonds_, [&](const Pair& p) {
    const double sum_of_radii = grains_.radius[p.i] + grains_.radius[p.j];
    return norm(motion.position[p.j] - motion.position[p.i] + box.offset(p.image)) > (1.0 + reach) * sum_of_radii;
  });
  if (!clumps_.empty()) clumps_.drop_internal(bonds_);
  built_ = false;
  const double grains = static_cast<double>(std::max<std::size_t>(grains_.size(), 1));
  return {bonds_.size(), 2.0 * static_cast<double>(bonds_.size()) / grains};
}

void DemEngine::set_walls(std::vector<Wall> walls) {
  for (std::size_t w = 0; w < walls.size(); ++w) {
    const double length = norm(walls[w].normal);
    if (!(std::fabs(length - 1.0) < 1e-6) || !(walls[w].friction >= 0.0))
      throw RequestError("WALLS",
                         "wall " + std::to_string(w) + " has a normal of length " + std::to_string(length) +
                             " and friction " + std::to_string(walls[w].friction),
                         "normals must have length 1, friction must be at least 0");
    walls[w].normal /= splat(length);
  }
  walls_ = Walls{};
  walls_.walls = std::move(walls);
}

void DemEngine::set_block(const BlockSetup& setup) {
  try {
    block_.set(setup);
  } catch (const std::invalid_argument& error) {
    throw RequestError("BLOCK", error.what(), "give a closed convex polyhedron and a mass above 0");
  }
}

void DemEngine::set_sponge(std::vector<std::int32_t> grains, std::vector<double> beta, std::size_t hats,
                           const std::vector<std::int32_t>& row_ptr, const std::vector<std::int32_t>& columns,
                           const std::vector<double>& values) {
  try {
    sponge_.set(std::move(grains), std::move(beta), hats, row_ptr, columns, values, motion);
  } catch (const std::logic_error& error) {
    throw RequestError("SPONGE", error.what(), "send one row of hats and one beta in 0 to 1 per grain");
  }
}

Domain DemEngine::domain() const {
  Domain box{options.box_lo, options.box_hi, {}};
  for (int axis = 0; axis < 3; ++axis) box.periodic[axis] = options.periodic[axis];
  return box;
}

void DemEngine::check_setup() const {
  if (grains_.size() == 0) throw RequestError("PREPARE", "there are no grains", "send GRAINS first");
  for (std::size_t i = 0; i < grains_.size(); ++i)
    if (grains_.material[i] < 0 || static_cast<std::size_t>(grains_.material[i]) >= grains_.materials.size())
      throw RequestError("GRAINS material",
                         grain_name(i) + " has material " + std::to_string(grains_.material[i]) + ", but there are " +
                             std::to_string(grains_.materials.size()),
                         "send GRAIN_MATERIALS with every material that grains use");
  if (contact_options_.geometry == Geometry::updated) return;
  const char* advice = "use geometry 'updated', or bonds of infinite strength";
  if (!clumps_.empty())
    throw RequestError("CONTACT_OPTIONS geometry", "frozen geometry knows no clumps", "use geometry 'updated'");
  if (bonds_.empty())
    throw RequestError("CONTACT_OPTIONS geometry", "frozen geometry needs bonds, there are none", advice);
  if (!walls_.empty() || block_.present())
    throw RequestError("CONTACT_OPTIONS geometry", "frozen geometry knows neither walls nor the block", advice);
  for (const Pair& p : bonds_)
    for (const std::int32_t g : {p.i, p.j}) {
      const GrainMaterial& m = grains_.material_of(g);
      if (!std::isinf(m.normal_strength) || !std::isinf(m.shear_strength))
        throw RequestError(
            "CONTACT_OPTIONS geometry",
            "frozen geometry needs bonds that cannot break, but " + grain_name(g) + " has bonds of finite strength",
            advice);
    }
}

ContactSource DemEngine::source() const {
  return {grains_,          motion.position, built_domain_, weights, contact_.law == LawKind::breakable_bond,
          contact_.rolling, contact_.damped};
}

LawKind DemEngine::choose_law() const {
  if (bonds_.empty()) return LawKind::friction;
  for (const GrainMaterial& m : grains_.materials)
    if (!std::isinf(m.normal_strength) || !std::isinf(m.shear_strength)) return LawKind::breakable_bond;
  return LawKind::elastic_bond;
}

VecField DemEngine::present_positions() const {
  VecField now(grains_.size());
  for (std::size_t i = 0; i < now.size(); ++i) now[i] = motion.position[i] + motion.displacement[i];
  return now;
}

bool DemEngine::needs_building() const {
  bool as_built = built_ && same(options.box_lo, built_options_.box_lo) &&
                  same(options.box_hi, built_options_.box_hi) && same(weights.outer_lo, built_weights_.outer_lo) &&
                  same(weights.outer_hi, built_weights_.outer_hi) && weights.width == built_weights_.width &&
                  weights.floor == built_weights_.floor;
  for (int axis = 0; axis < 3; ++axis) as_built = as_built && options.periodic[axis] == built_options_.periodic[axis];
  return !as_built;
}

void DemEngine::build_contacts() {
  const bool frozen = contact_options_.geometry == Geometry::frozen;
  const double skin = contact_options_.skin > 0.0 ? contact_options_.skin : default_skin;
  skin_ = frozen ? 0.0 : skin * grains_.mean_radius();
  built_domain_ = domain();
  contact_ = ContactForces{};
  contact_.law = choose_law();
  contact_.rotating = contact_options_.rotations;
  for (const GrainMaterial& m : grains_.materials) {
    contact_.rolling = contact_.rolling || (contact_.rotating && resists_rolling(m));
    contact_.damped = contact_.damped || m.damping_ratio > 0.0;
  }
  auto candidates = frozen ? std::vector<Pair>{} : pairs_of(present_positions(), grains_.radius, skin_, built_domain_);
  if (!clumps_.empty()) clumps_.drop_internal(candidates);
  contact_.table = first_table(source(), bonds_, candidates);
  contact_.threads = threads;
  contact_.table_changed(grains_.size());
  refuse_overlaps();
  set_masses();
  if (!clumps_.empty()) clumps_.build(built_domain_, motion, rotation_);
  if (frozen)
    frozen_.build(contact_.table, VecField(grains_.size(), Vec{}), 0.0);
  else
    contact_.springs_from_displacements(motion.displacement, rotation_.angle);
  displacement_at_build_ = motion.displacement;
  strain_at_build_ = 0.0;
  built_ = true;
  built_options_ = options;
  built_weights_ = weights;
  past_step_ = 0.0;
  rebuilds_ = fast_ = steps_ = 0;
  lost_.clear();
}

void DemEngine::refuse_overlaps() const {
  contact_.table.each([&](std::size_t i, std::size_t c) {
    if (contact_.table.state[c] & bonded) return;
    const auto j = static_cast<std::size_t>(contact_.table.second[c]);
    const Vec du = motion.displacement[j] - motion.displacement[i];
    const double overlap = -reach_of(contact_.table, c, du).elongation;
    const double smaller = std::min(grains_.radius[i], grains_.radius[j]);
    if (overlap > largest_overlap * smaller)
      throw RequestError("GRAINS position",
                         "grains " + std::to_string(i) + " and " + std::to_string(j) + " overlap by " +
                             std::to_string(overlap) + " m, radii " + std::to_string(grains_.radius[i]) + " and " +
                             std::to_string(grains_.radius[j]),
                         "relax the packing, or bond it so that it is stress-free as it stands");
  });
}

void DemEngine::set_masses() {
  // w_i is the mean of w_c over the bonds: then the weights cost no stable step
  std::vector<double> total(grains_.size(), 0.0);
  std::vector<std::int32_t> count(grains_.size(), 0);
  const ContactTable& table = contact_.table;
  // weights vary within a grain at a border: a pair that may soon touch there must not find a mass without its share
  const double near = weights.border() ? near_gap * grains_.mean_radius() : -INFINITY;
  table.each([&](std::size_t i, std::size_t c) {
    Vec branch = table.branch[c];
    branch[3] = 0.0;
    const double gap = norm(branch) - grains_.radius[i] - grains_.radius[static_cast<std::size_t>(table.second[c])];
    if (!(table.state[c] & bonded) && gap > near) return;
    const double w = contact_weight(source(), i, table.second[c], branch, true);
    for (const std::size_t g : {i, static_cast<std::size_t>(table.second[c])}) {
      total[g] += w;
      ++count[g];
    }
  });
  constexpr double sphere = 2.0 / 5.0;
  for (std::size_t i = 0; i < grains_.size(); ++i) {
    const double w = count[i] > 0 ? total[i] / count[i] : weights.at(motion.position[i]);
    motion.plain_mass[i] = grains_.plain_mass(i);
    motion.mass[i] = w * motion.plain_mass[i];
    rotation_.inertia[i] = sphere * motion.mass[i] * grains_.radius[i] * grains_.radius[i];
    if (!(motion.mass[i] > 0.0))
      throw RequestError("WEIGHTS", grain_name(i) + " has weight " + std::to_string(w), "use a floor above 0");
  }
}

void DemEngine::hold_rotations() {
  held_groups_ = rotation_groups();
  for (std::size_t i = 0; i < grains_.size(); ++i) rotation_.mobility[i] = 1.0 / rotation_.inertia[i];
  if (!contact_options_.rotations) std::fill(rotation_.mobility.begin(), rotation_.mobility.end(), 0.0);
  for (std::size_t g = 0; g < boundary.constraints().size(); ++g)
    if (boundary.rotations_locked(g))
      for (const std::int32_t e : boundary.constraints()[g].entities) {
        rotation_.mobility[e] = 0.0;
        rotation_.spin[e] = Vec{};
      }
  for (std::size_t i = 0; i < grains_.size(); ++i)
    if (!grains_.material_of(i).rotates) {
      rotation_.mobility[i] = 0.0;
      rotation_.spin[i] = Vec{};
    }
}

void DemEngine::find_surfaces() {
  if (!walls_.empty()) walls_.find(source(), motion.displacement, skin_);
  if (block_.present()) block_.find(source(), motion.displacement, 2.0 * skin_);
}

void DemEngine::prepare() {
  phase = "building contacts";
  flush_denormals(threads);
  check_setup();
  if (motion.measured != options.measure_energy) {
    motion.measured = options.measure_energy;
    motion.old_velocity.assign(motion.measured ? motion.size() : 0, Vec{});
    motion.damping_force.assign(motion.measured ? motion.size() : 0, Vec{});
  }
  rotation_.set_measured(options.measure_energy);
  motion.threads = rotation_.threads = contact_.threads = threads;
  if (needs_building())
    build_contacts();
  else
    contact_.table_changed(grains_.size());
  boundary.apply_to(motion);
  if (!clumps_.empty()) refuse_bound_clumps();
  hold_rotations();
  find_surfaces();
  step_size_ = 0.0;
  phase = "idle";
}

std::uint64_t DemEngine::rotation_groups() const {
  engine::Hash hash;
  for (const engine::Constraint& c : boundary.constraints()) {
    hash.add(static_cast<std::uint64_t>(c.components));
    hash.add(static_cast<std::uint64_t>(c.entities.size()));
    hash.add(reinterpret_cast<std::uint64_t>(c.entities.data()));
  }
  return hash.value();
}

double DemEngine::stable_step() {
  phase = "finding the stable step";
  if (!clumps_.empty()) refuse_bound_clumps();
  double highest = 0.0, viscous = 0.0;
  const bool rotating = contact_options_.rotations;
  const Clumps* bodies = &clumps_;
  if (contact_options_.geometry == Geometry::frozen) {
    highest = highest_eigenvalue(frozen_, motion, rotation_, contact_options_.rotations).highest;
  } else {
    const double near = std::min(near_gap * grains_.mean_radius(), skin_);
    LinearNetwork network;
    network.build(contact_.table, motion.displacement, near);
    std::vector<SurfaceSpring> springs;
    walls_.add_springs(grains_, near, springs);
    const Spectra of_block = block_.add_springs(grains_, near, springs);
    if (contact_.rolling) network.add_rolling(contact_.table, motion.displacement, near);
    if (contact_.damped) {
      LinearNetwork dashpots;
      dashpots.build_dashpots(contact_.table, motion.displacement, near, springs);
      viscous = std::max(of_block.viscosity, highest_eigenvalue(dashpots, motion, rotation_, rotating, bodies).highest);
    }
    network.add_surface(std::move(springs));
    highest = std::max(of_block.stiffness, highest_eigenvalue(network, motion, rotation_, rotating, bodies).highest);
    // contacts may form at any time: never less than what two equal grains give; in a clump they move less easily
    constexpr double normal_share = 1.0, shear_share = 3.5, rolling_share = 2.5;
    for (std::size_t i = 0; i < grains_.size(); ++i) {
      const GrainMaterial& m = grains_.material_of(i);
      const double per_mass = grains_.radius[i] / motion.plain_mass[i], turning = rotating ? shear_share : normal_share;
      double k = std::max(normal_share * m.normal_stiffness, turning * m.shear_stiffness);
      if (contact_.rolling && resists_rolling(m))
        k = std::max(k, rolling_share * m.rolling_stiffness * m.shear_stiffness);
      highest = std::max(highest, k * per_mass);
      const double c = std::max(normal_share * std::sqrt(m.normal_stiffness), turning * std::sqrt(m.shear_stiffness));
      viscous = std::max(viscous, 2.0 * m.damping_ratio * c * std::sqrt(per_mass));
    }
  }
  phase = "idle";
  if (!(highest > 0.0))
    throw engine::PhysicsError("stable step", "no grain is held by any spring or free to move",
                               "check bonds and constraints");
  // dashpots take the velocity of half a step before: 4 M - dt^2 K - 2 dt C must stay positive
  return 4.0 / (viscous + std::sqrt(viscous * viscous + 4.0 * highest));
}

}  // namespace gabion::dem
