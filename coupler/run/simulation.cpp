#include "coupler/run/simulation.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "coupler/ground/probe_rows.hpp"
#include "coupler/interface/rotation.hpp"

namespace gabion::coupler {

namespace {

using Clock = std::chrono::steady_clock;

/// Beyond this share of the ground's smallest side the interface's motion is looked at for rotation.
constexpr double look_for_rotation = 0.1;
/// Time between two rows of block.csv, s, and the steps between them at most.
constexpr double block_row_time = 1e-3;
constexpr double most_block_row_steps = 50;
/// Steps between two looks at what yields, at least.
constexpr std::uint64_t steps_between_looks = 40;

std::string hex(std::uint64_t value) {
  char text[24];
  std::snprintf(text, sizeof text, "%016llx", static_cast<unsigned long long>(value));
  return text;
}

std::string number(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%.4g", value);
  return text;
}

}  // namespace

Simulation::Simulation(const scene::Scene& scene, const std::string& scene_hash, RunFolder& folder, EngineLink* dem,
                       EngineLink* continuum, Activity& activity)
    : scene_(scene), scene_hash_(scene_hash), folder_(folder), dem_(dem), continuum_(continuum), activity_(activity), log_([this](const std::string& line) { folder_.log(line); }) {}

nlohmann::json Simulation::run() {
  const auto begin = Clock::now();
  prepare();
  wall_preparing_ = std::chrono::duration<double>(Clock::now() - begin).count();
  const std::size_t first = resumed_.is_null() ? 0 : restore_checkpoint();
  for (std::size_t s = first; s < scene_.stages.size(); ++s) {
    const scene::Stage& stage = scene_.stages[s];
    if (s > first || resumed_.is_null()) begin_stage(s);
    run_stage(stage);
  }
  progress_.end_line();
  recorder_->close();
  if (zone_watch_)
    for (std::string& advice : zone_watch_->advice(recorder_->energy().largest_energy(), largest_tied_damage_)) warnings_.push_back(std::move(advice));
  nlohmann::json result = summary();
  result["wall"]["total"] = std::chrono::duration<double>(Clock::now() - begin).count();
  folder_.write_json("summary.json", result);
  // energy that comes or goes shows in both measures; the bare one is right for short motion, the other for waves
  const EnergyBalance& energy = recorder_->energy();
  const double error = rates_used_.is_null() ? energy.error() : std::min(energy.error(), energy.error_with_swing());
  const bool swings = !rates_used_.is_null() && scene_.mesh.rates->energy_tolerance > scene_.run.energy_tolerance;
  const double tolerance = swings ? scene_.mesh.rates->energy_tolerance : scene_.run.energy_tolerance;
  if (scene_.run.measure_energy && error > tolerance)
    throw RunFailed("the energy balance is off by " + number(error) + " of the largest energy, above " +
                    (swings ? "mesh.rates.energy_tolerance " : "run.energy_tolerance ") + number(tolerance) + "; look at energy.csv for the entry that grows");
  return result;
}

void Simulation::prepare() {
  activity_.is("preparing");
  const Cache cache;
  packing_ = obtain_packing(scene_, dem_, cache, log_);
  log_("packing: " + std::to_string(packing_.position.size()) + " grains, solid fraction " + number(packing_.solid_fraction) +
       ", " + number(packing_.contacts_per_grain) + " contacts per grain, " + std::to_string(packing_.rattlers) +
       " rattlers removed, bonding gap " + number(packing_.gap));
  Elasticity elasticity;
  if (needs_elasticity(scene_)) {
    elasticity = obtain_elasticity(scene_, packing_, dem_, cache, log_);
    const IsotropicFit fit = isotropic_fit(elasticity.stiffness);
    log_("continuum: E " + number(fit.young) + " Pa, nu " + number(fit.poisson) + ", misfit " + number(fit.misfit) +
         ", density " + number(elasticity.density) + " kg/m3");
  }
  assembly_ = assemble(scene_, packing_, elasticity);
  if (!assembly_.has_grains) dem_ = nullptr;
  if (!assembly_.has_mesh) continuum_ = nullptr;
  if (dem_) {
    const protocol::Ready ready = configure_dem(scene_, assembly_, *dem_, log_);
    grain_mass_ = ready.mass.data;
    for (std::size_t g = 0; g < grain_mass_.size(); ++g) grain_weights_.push_back(grain_mass_[g] / ready.plain_mass[g]);
  }
  if (continuum_) node_mass_ = configure_continuum(scene_, assembly_, *continuum_).mass.data;
  faces_.emplace(scene_, assembly_, dem_, continuum_);
  if (dem_ && continuum_) {
    try {
      tie_.emplace(scene_, assembly_, *dem_, *continuum_);
    } catch (const std::runtime_error& problem) {
      throw ScenarioError(std::string("coupling: ") + problem.what());
    }
  }
  const bool gravity = scene_.gravity != scene::Point{};
  if (gravity && dem_ && continuum_ && scene_.model == scene::Model::edge) trim_gravity(scene_, assembly_, grain_weights_, *dem_);
  for (const scene::Stage& stage : scene_.stages) {
    if (!stage.gravity) throw ScenarioError("stages.gravity: false is not supported in stage '" + stage.name + "'; leave it out, or set gravity to 0 for the whole scene");
  }
  recorder_.emplace(folder_, scene_, assembly_, grain_weights_);
  if (dem_) {
    zone_watch_.emplace(assembly_.zone, assembly_.grains, tie_ ? &tie_->rows() : nullptr);
    recorder_->show_damage(zone_watch_->damage());
  }
  if (tie_) recorder_->interface_geometry(*tie_);
  if (scene_.block && dem_) recorder_->block_shape(placed_block(assembly_.grains));
  stepper_.emplace(dem_, continuum_, tie_ ? &*tie_ : nullptr);
  rates_.emplace(tie_ ? scene_.mesh.rates : std::nullopt, assembly_.mesh, continuum_);
}

/// Where the probes are; sampled whenever all nodes stand at one time.
void Simulation::place_probes() {
  protocol::Probes in_grains, in_mesh;
  for (auto* p : {&in_grains, &in_mesh}) p->row_ptr = std::vector<std::int32_t>{0};
  for (const scene::Probe& probe : scene_.probes) {
    const bool grains = dem_ && (!continuum_ || (assembly_.zone.beyond_outer(probe.at) <= 0.0 && assembly_.zone.weight(probe.at) >= 0.5));
    const ProbeRow row = grains ? probe_in_grains(probe.at, assembly_.grains, scene_.ground.box, scene_.ground.periodic)
                                : probe_in_mesh(probe.at, assembly_.mesh, assembly_.zone);
    protocol::Probes& target = grains ? in_grains : in_mesh;
    target.names.push_back(probe.name);
    target.entities.data.insert(target.entities.data.end(), row.entities.begin(), row.entities.end());
    target.coefficients.data.insert(target.coefficients.data.end(), row.coefficients.begin(), row.coefficients.end());
    target.row_ptr.data.push_back(static_cast<std::int32_t>(target.entities.size()));
  }
  for (auto* p : {&in_grains, &in_mesh}) {
    p->row_ptr.set_shape(std::array<std::uint64_t, 1>{p->row_ptr.size()});
    p->entities.set_shape(std::array<std::uint64_t, 1>{p->entities.size()});
    p->coefficients.set_shape(std::array<std::uint64_t, 1>{p->coefficients.size()});
    p->every = rates_->period();
  }
  recorder_->set_probes(in_grains.names, in_mesh.names);
  if (!in_grains.names.empty()) dem_->tell(in_grains);
  if (!in_mesh.names.empty()) continuum_->tell(in_mesh);
}

double Simulation::stable_step() {
  double limit = scene::infinity;
  const auto ask = [&](EngineLink& link) {
    const double step = link.ask<protocol::Ready>(protocol::StableStep{}).stable_step;
    if (!(step > 0.0)) throw RunFailed(link.role() + "_server gives its stable step as " + number(step) + " s; expected a number above 0");
    limit = std::min(limit, step);
    return step;
  };
  if (dem_) stable_dem_ = ask(*dem_);
  if (continuum_) stable_continuum_ = ask(*continuum_);
  return limit;
}

double Simulation::choose_step(const scene::Stage& stage) {
  // local damping cuts the limit to 1/sqrt(1 + alpha) of the undamped one (docs/theory.md, "Stable step")
  const double limit = stable_step() / std::sqrt(1.0 + stage.damping);
  if (scene_.run.step) {
    if (*scene_.run.step > limit)
      throw ScenarioError("run.step: " + number(*scene_.run.step) + " s is above the stable step of stage '" + stage.name + "', " +
                          number(limit) + " s; lower it, or leave it out to have it chosen");
    return *scene_.run.step;
  }
  return scene_.run.step_fraction * limit;
}

/// Turns several rates on where the stage's motion is undamped, and checks that they are stable.
void Simulation::choose_rates(const scene::Stage& stage, double dt) {
  if (rates_->period() == 1 || stage.damping > 0.0) return;
  const std::uint64_t fits = rates_->fit(dt);
  if (rates_->fixed() && fits < rates_->period())
    throw ScenarioError("mesh.rates.largest: at a step of " + number(dt) + " s in stage '" + stage.name + "' elements of rate " +
                        std::to_string(rates_->period()) + " are above 0.9 of their stable step; " +
                        (fits > 1 ? "the largest rate that fits is " + std::to_string(fits) : "no rate above 1 fits") +
                        ": set it, or 'auto', or make the elements larger");
  if (fits == 1) return;
  const std::vector<std::size_t> counts = rates_->elements();
  std::string text;
  nlohmann::json elements;
  for (std::size_t k = 0; k < counts.size(); ++k) {
    const std::string rate = std::to_string(std::uint64_t{1} << k);
    elements[rate] = counts[k];
    text += (k > 0 ? ", " : "") + std::to_string(counts[k]) + " of rate " + rate;
  }
  rates_used_ = {{"largest", fits}, {"elements", elements}};
  log_("rates: elements " + text);
}

/// As many steps or a few more, so that all nodes stand at one time.
std::uint64_t Simulation::whole_periods(std::uint64_t steps) const {
  const std::uint64_t period = rates_->period();
  return (steps + period - 1) / period * period;
}

void Simulation::set_step(double dt) {
  dt_ = dt;
  if (!tie_) return;
  const bool absorb = scene_.stages[at_.stage].damping == 0.0;
  tie_->set_step(dt, faces_->grain_inertia(grain_mass_, dt), faces_->node_inertia(node_mass_, dt), grain_weights_, absorb);
  const InterfaceReport& r = tie_->report();
  log_("interface: " + std::to_string(r.grains) + " grains tied by " + std::to_string(r.rows) + " rows (" + number(r.grains_per_row) +
       " grains a row), rank " + std::to_string(r.rank) + ", condition " + number(r.condition) + ", " + std::to_string(r.merged_rows) + " rows merged");
  if (r.rank < r.rows)
    warnings_.push_back("the interface has " + std::to_string(r.rows) + " rows of rank " + std::to_string(r.rank) +
                        ": more multipliers than the grains can carry; the reduced solve is used. Coarser rows: mortar2h or a larger mesh.size");
}

void Simulation::apply_faces(std::size_t index, double start) {
  if (index == 0)
    for (int face = 0; face < 6; ++face)
      if (!scene_.ground.periodic[face / 2]) faces_->apply(face, scene_.faces[face]);
  for (const auto& [face, condition] : scene_.stages[index].faces) {
    scene::Face moved = condition;
    moved.history = scene::shifted(condition.history, start);
    faces_->apply(face, moved);
  }
}

void Simulation::begin_stage(std::size_t index) {
  const scene::Stage& stage = scene_.stages[index];
  const bool first = index == 0;
  activity_.is("beginning a stage");
  rates_->cut(1);
  apply_faces(index, stepper_->time());
  if (scene_.block && scene_.block->stage == static_cast<int>(index)) release_block();

  if (stage.zero_displacements) recorder_->zero_displacements(dem_, continuum_);

  double dt = choose_step(stage);
  if (first) {
    rates_->plan(scene_.run.step ? dt : dt * std::sqrt(1.0 + stage.damping));
    place_probes();
    if (tie_ && scene_.mesh.rates && rates_->period() == 1)
      warnings_.push_back("mesh.rates: every element is evaluated in every step, since none is far enough from the overlap or border, or none could take two steps at once; "
                          "leave it out, or lower its layers, or make the elements larger");
  }
  // ends at the first of duration, steps and until; at_least holds for until alone
  std::uint64_t most = stage.steps > 0 ? stage.steps : stage.max_steps;
  if (std::isfinite(stage.duration)) {
    const std::uint64_t whole = whole_periods(static_cast<std::uint64_t>(std::ceil(stage.duration / dt)));
    dt = stage.duration / static_cast<double>(whole);
    most = stage.steps > 0 ? std::min(most, whole) : whole;
  }
  most = whole_periods(most);
  choose_rates(stage, dt);
  at_ = {.stage = index, .taken = 0, .most = most, .least = static_cast<std::uint64_t>(std::ceil(stage.at_least / dt)),
         .unbalanced = scene::infinity};
  set_step(dt);
  if (first) {
    try {
      start_motion(scene_, assembly_, dt, dem_, continuum_, [this](std::size_t node) { return rates_->node_rate(node); });
    } catch (const std::runtime_error& problem) {
      if (scene_.initial.state.empty()) throw;
      throw ScenarioError(problem.what());
    }
    recorder_->state(stage.name, 0, 0.0, dt, dem_, continuum_, tie_ ? &*tie_ : nullptr);
    next_output_ = scene_.output.every;
  }
  log_("stage " + stage.name + ": dt " + number(dt) + " s (stable " + number(stable_dem_) + " s grains, " + number(stable_continuum_) + " s continuum)");
}

void Simulation::run_stage(const scene::Stage& stage) {
  auto& [index, taken, most, least, unbalanced] = at_;
  const bool until_still = stage.unbalanced > 0.0, limited = stage.steps > 0 || std::isfinite(stage.duration);
  const auto rested = [&, &taken = taken, &least = least, &unbalanced = unbalanced] {
    return until_still && taken >= least && unbalanced < stage.unbalanced;
  };
  while (taken < most && !rested()) {
    std::uint64_t chunk = std::min<std::uint64_t>(std::max<std::uint64_t>(1, scene_.output.monitor_steps), most - taken);
    if (taken == 0) chunk = 1;  // the stage's own first balance
    const std::uint64_t period = rates_->period();
    if (block_) chunk = std::min(chunk, static_cast<std::uint64_t>(std::clamp(block_row_time / dt_, 1.0, most_block_row_steps)));
    if (scene_.output.every > 0.0)
      chunk = std::min(chunk, std::max<std::uint64_t>(1, static_cast<std::uint64_t>(std::ceil((next_output_ - stepper_->time()) / dt_ - 1e-6))));
    chunk = block_ ? std::max(period, chunk / period * period) : whole_periods(chunk);
    activity_.is("stepping");
    last_ = stepper_->advance(chunk, dt_, stage.damping, scene_.run.measure_energy ? period : 0);
    taken += chunk;
    element_steps_ += rates_->element_steps(chunk);
    grain_steps_ += chunk * assembly_.grains.position.size();
    unbalanced = 0.0;
    for (const auto* report : {&last_.dem, &last_.continuum})
      if (*report) unbalanced = std::max(unbalanced, (*report)->unbalanced);
    activity_.is("writing results");
    recorder_->monitor(stage.name, stepper_->step(), stepper_->time(), dt_, last_, progress_.steps_per_second());
    progress_.show(stage.name, stepper_->step(), stepper_->time(), limited ? static_cast<double>(taken) / static_cast<double>(most) : -1.0,
                   unbalanced, recorder_->energy().error());
    if (block_) recorder_->block_row(stepper_->time(), *block_, dem_->fetch("block"), dem_->fetch("block_forces"), chunk);
    watch(stage, last_);
    look_at_zone(stage, chunk, taken >= most || rested());
    if (scene_.output.every > 0.0 && stepper_->time() >= next_output_ - 0.5 * dt_) {
      recorder_->state(stage.name, stepper_->step(), stepper_->time(), dt_, dem_, continuum_, tie_ ? &*tie_ : nullptr);
      next_output_ += scene_.output.every;
    }
    const bool stopping = stop_ && *stop_;
    if (stopping || checkpoint_due()) save_checkpoint();
    if (stopping) {
      recorder_->close();
      throw Interrupted("interrupted at step " + std::to_string(stepper_->step()) + ", results up to t = " + number(stepper_->time()) + " s");
    }
  }
  if (until_still && !limited && !rested())
    throw RunFailed("stage '" + stage.name + "' is not at rest after " + std::to_string(taken) + " steps: unbalanced " + number(unbalanced) +
                    ", wanted " + number(stage.unbalanced) + "; raise stages.max_steps or the damping, or look for a part that moves freely");
  if (until_still && limited && !rested())
    warnings_.push_back("stage '" + stage.name + "' ended after " + std::to_string(taken) + " steps, before it was at rest: unbalanced " +
                        number(unbalanced) + ", wanted " + number(stage.unbalanced));
  if (recorder_->last_state_step() != stepper_->step())
    recorder_->state(stage.name, stepper_->step(), stepper_->time(), dt_, dem_, continuum_, tie_ ? &*tie_ : nullptr);
  stages_.push_back({{"name", stage.name}, {"steps", taken}, {"time", stepper_->time()}, {"unbalanced", unbalanced}, {"dt", dt_}});
}

PlacedBlock Simulation::placed_block(const GrainSet& grains) const {
  try {
    PlacedBlock placed = place_block(*scene_.block, scene_.ground.box, grains);
    // the level at rest is that of the whole packing, the same in every model, however small the zone; what the grains have
    // settled is seen on those that this model has
    const GrainSet whole{packing_.position, packing_.radius, {}};
    placed.surface_level += mean_surface_level(scene_.ground.box, whole, *scene_.block) -
                            mean_surface_level(scene_.ground.box, assembly_.grains, *scene_.block);
    return placed;
  } catch (const std::runtime_error& problem) {
    throw ScenarioError(problem.what());
  }
}

/// Sets the block down on the grains as they lie now.
void Simulation::release_block() {
  GrainSet present = assembly_.grains;
  const std::vector<double> moved = dem_->fetch("displacement");
  for (std::size_t g = 0; g < present.position.size(); ++g)
    for (int axis = 0; axis < 3; ++axis) present.position[g][axis] += moved[3 * g + static_cast<std::size_t>(axis)];
  block_ = placed_block(present);
  tell_block();
  recorder_->block_released(stepper_->time(), block_->surface_level);
  log_("block: lowest corner at " + number(block_->lowest + scene_.origin[2]) + " m, mean surface level " +
       number(block_->surface_level + scene_.origin[2]) + " m");
}

void Simulation::tell_block() {
  protocol::Block message;
  std::vector<double> vertices;
  for (const Point& v : block_->vertices) vertices.insert(vertices.end(), v.begin(), v.end());
  message.vertices = vertices;
  message.face_ptr = block_->face_ptr;
  message.face_vertices = block_->face_vertices;
  message.mass = scene_.block->mass;
  message.velocity = std::vector<double>(scene_.block->velocity.begin(), scene_.block->velocity.end());
  message.spin = std::vector<double>(scene_.block->spin.begin(), scene_.block->spin.end());
  message.rotation = scene_.block->rotation ? 1 : 0;
  message.friction = scene_.block->friction;
  dem_->tell(message);
  dem_->ask<protocol::Ready>(protocol::Prepare{});
}

/// Share of the contacts of tied grains that slide or were broken.
double Simulation::tied_damage(const protocol::RunDone& report) {
  double contacts = 0.0, damaged = 0.0;
  for (std::size_t i = 0; i < report.counter_names.size(); ++i) {
    const std::string& name = report.counter_names[i];
    if (name == "tied_contacts" || name == "tied_broken") contacts += report.counters[i];
    if (name == "tied_sliding" || name == "tied_broken") damaged += report.counters[i];
  }
  return contacts > 0.0 ? damaged / contacts : 0.0;
}

/// Stops what cannot be trusted: motion that is no number, an interface that has turned too far.
void Simulation::watch(const scene::Stage& stage, const Advance& advance) {
  for (const auto* report : {&advance.dem, &advance.continuum})
    if (*report && !std::isfinite((*report)->largest_speed))
      throw RunFailed("stage '" + stage.name + "', step " + std::to_string((*report)->step) + ": a velocity is not a number");
  if (!tie_ || !advance.continuum) return;
  largest_tied_damage_ = std::max(largest_tied_damage_, tied_damage(*advance.dem));
  // the rotation of the interface is at most its motion over half its width
  double half_width = scene::infinity;
  for (int axis = 0; axis < 3; ++axis)
    half_width = std::min(half_width, 0.5 * (scene_.ground.box.hi[axis] - scene_.ground.box.lo[axis]));
  const double motion = std::max(advance.continuum->largest_displacement, advance.dem->largest_displacement);
  if (motion < look_for_rotation * scene_.coupling.rotation_limit * half_width) return;
  const std::vector<double> u = continuum_->fetch("displacement");
  const double rotation = interface_rotation(assembly_.mesh, tie_->rows(), u);
  largest_rotation_ = std::max(largest_rotation_, rotation);
  if (rotation > scene_.coupling.rotation_limit)
    throw RunFailed("stage '" + stage.name + "': the interface has turned by " + number(rotation) + " rad, beyond coupling.rotation_limit " +
                    number(scene_.coupling.rotation_limit) + "; linear elements take it for a strain of " + number(0.5 * rotation * rotation) + ". Enlarge grains.zone so that the interface lies in ground that does not turn");
}

/// Only while nothing damps the motion: a stage that comes to rest is not what the zone is for. Always at a stage's end.
void Simulation::look_at_zone(const scene::Stage& stage, std::uint64_t steps, bool last) {
  if (!zone_watch_ || stage.damping > 0.0) return;
  steps_to_look_ -= std::min(steps, steps_to_look_);
  if (steps_to_look_ > 0 && !last) return;
  steps_to_look_ = steps_between_looks;
  zone_watch_->look(dem_->fetch("yield"), zone_watch_->needs_velocity() ? dem_->fetch("velocity") : std::vector<double>{});
}

nlohmann::json Simulation::summary() const {
  nlohmann::json s;
  static const std::map<scene::Model, const char*> names{
      {scene::Model::dem, "dem"}, {scene::Model::continuum, "continuum"}, {scene::Model::bridging, "bridging"}, {scene::Model::edge, "edge"}};
  s["scene"] = resumed_.is_null() ? scene_.name : resumed_.at("scene").get<std::string>();
  if (!resumed_.is_null()) s["resumed"] = {{"step", resumed_.at("step")}, {"time", resumed_.at("time")}};
  s["title"] = scene_.title;
  s["model"] = names.at(scene_.model);
  if (last_.dem) s["state_hash"]["dem"] = hex(last_.dem->state_hash);
  if (last_.continuum) s["state_hash"]["continuum"] = hex(last_.continuum->state_hash);
  s["sizes"] = {{"grains", assembly_.grains.position.size()}, {"nodes", assembly_.mesh.nodes.size()}, {"elements", assembly_.mesh.elements.size()},
                {"packing", packing_.position.size()}, {"grain_steps", grain_steps_}, {"element_steps", element_steps_}};
  s["packing"] = {{"solid_fraction", packing_.solid_fraction}, {"contacts_per_grain", packing_.contacts_per_grain}, {"gap", packing_.gap},
                  {"rattlers", packing_.rattlers}, {"residual_overlap", packing_.residual_overlap}, {"mean_diameter", packing_.mean_diameter()}};
  if (needs_elasticity(scene_)) {
    const IsotropicFit fit = isotropic_fit(assembly_.elasticity.stiffness);
    s["elasticity"] = {{"young", fit.young}, {"poisson", fit.poisson}, {"misfit", fit.misfit}, {"density", assembly_.elasticity.density},
                       {"stiffness", assembly_.elasticity.stiffness}};
  }
  if (tie_) {
    const InterfaceReport& r = tie_->report();
    s["interface"] = {{"grains", r.grains}, {"rows", r.rows}, {"rank", r.rank}, {"condition", r.condition}, {"merged_rows", r.merged_rows}, {"nonzeros", r.nonzeros}, {"largest_rotation", largest_rotation_}, {"largest_damaged_share", largest_tied_damage_}};
  }
  if (zone_watch_)
    if (nlohmann::json zone = zone_watch_->verdict(recorder_->energy().largest_energy()); !zone.is_null()) s["zone"] = zone;
  if (last_.dem)
    for (std::size_t i = 0; i < last_.dem->counter_names.size(); ++i) s["counters"][last_.dem->counter_names[i]] = last_.dem->counters[i];
  s["step"] = {{"dt", dt_}, {"count", stepper_->step()}, {"stable_dem", stable_dem_}, {"stable_continuum", stable_continuum_}, {"time", stepper_->time()}};
  const StepTimes& t = stepper_->times();
  const double steps = std::max<double>(1.0, static_cast<double>(t.steps));
  s["wall"] = {{"preparing", wall_preparing_}, {"stepping", t.total}, {"us_per_step", 1e6 * t.total / steps}, {"dem_wait", t.waiting_dem},
               {"continuum_wait", t.waiting_continuum}, {"solve", t.solving}};
  s["bytes_per_step"] = static_cast<double>(t.bytes) / steps;
  const EnergyBalance& energy = recorder_->energy();
  s["energy"] = {{"balance_error", energy.error()}, {"largest", energy.largest_energy()}, {"dissipated", energy.dissipated()},
                 {"multiplier_work_residual", energy.multiplier_residual()}};
  if (!rates_used_.is_null()) {
    s["rates"] = rates_used_;
    s["rates"]["energy_excursion"] = energy.excursion();
    s["rates"]["energy_excursion_with_swing"] = energy.excursion_with_swing();
  }
  for (const auto* report : {&last_.dem, &last_.continuum})
    if (*report) s["momentum"][report == &last_.dem ? "dem" : "continuum"] = (*report)->momentum.data;
  s["stages"] = stages_;
  s["figures"] = recorder_->figures();
  s["warnings"] = warnings_;
  return s;
}

}  // namespace gabion::coupler
