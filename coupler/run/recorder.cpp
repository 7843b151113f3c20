#include "coupler/run/recorder.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace gabion::coupler {

namespace {

/// origin is added: results are in the user's coordinates.
std::vector<double> flat(const std::vector<Point>& points, const Point& origin) {
  std::vector<double> values;
  for (const Point& p : points)
    for (int axis = 0; axis < 3; ++axis) values.push_back(p[axis] + origin[axis]);
  return values;
}

/// Field names, components and units that a state holds.
struct FieldOf {
  const char* name;
  int components;
  const char* unit;
};
constexpr FieldOf grain_fields[] = {{"velocity", 3, "m/s"}, {"spin", 3, "rad/s"}, {"broken", 1, ""}};
constexpr FieldOf node_fields[] = {{"velocity", 3, "m/s"}};
constexpr FieldOf cell_fields[] = {{"stress", 6, "Pa"}};

std::vector<double> less(std::vector<double> values, const std::vector<double>& taken) {
  for (std::size_t k = 0; k < taken.size(); ++k) values[k] -= taken[k];
  return values;
}

/// Sum of a sparse row times a field of points, three components.
Point row_times(const SparseRows& rows, std::size_t r, const std::vector<double>& field) {
  Point sum{};
  for (std::int32_t k = rows.row_ptr[r]; k < rows.row_ptr[r + 1]; ++k)
    for (std::size_t axis = 0; axis < 3; ++axis)
      sum[axis] += rows.values[static_cast<std::size_t>(k)] * field[3 * static_cast<std::size_t>(rows.columns[static_cast<std::size_t>(k)]) + axis];
  return sum;
}

}  // namespace

Recorder::Recorder(RunFolder& folder, const scene::Scene& scene, const Assembly& assembly,
                   const std::vector<double>& grain_weights)
    : folder_(folder), scene_(scene), assembly_(assembly), results_(folder.file("results.h5")) {
  results_.attribute("title", scene.title);
  results_.attribute("scene", scene.name);
  if (assembly.has_grains) {
    const std::vector<double> position = flat(assembly.grains.position, scene.origin);
    const std::vector<std::int64_t> origin(assembly.origin.begin(), assembly.origin.end());
    results_.write_grain_geometry({position, assembly.grains.radius, assembly.material, origin, grain_weights, assembly.clump});
  }
  if (assembly.has_mesh) {
    const std::vector<double> nodes = flat(assembly.mesh.nodes, scene.origin);
    std::vector<std::int32_t> elements;
    std::vector<std::uint8_t> wrap;
    for (const auto& e : assembly.mesh.elements) elements.insert(elements.end(), e.begin(), e.end());
    for (const auto& w : assembly.mesh.wrap) wrap.insert(wrap.end(), w.begin(), w.end());
    std::vector<double> weight;
    for (const Cell& cell : assembly.mesh.cells) {
      const Point centre = assembly.mesh.grid.cell_centre(cell);
      const bool shared = assembly.coupled() && assembly.zone.overlap() > 0.0 && assembly.zone.beyond_outer(centre) < 0.0;
      weight.push_back(shared ? 1.0 - assembly.zone.weight(centre) : 1.0);
    }
    std::array<double, 3> period;
    for (int axis = 0; axis < 3; ++axis) period[axis] = scene.ground.box.hi[axis] - scene.ground.box.lo[axis];
    const std::vector<std::int32_t> material(assembly.mesh.elements.size(), 0);
    results_.write_mesh_geometry({nodes, elements, wrap, period, material, weight});
  }
}

void Recorder::set_probes(std::vector<std::string> dem, std::vector<std::string> continuum) {
  dem_probes_ = std::move(dem);
  continuum_probes_ = std::move(continuum);
  if (dem_probes_.empty() && continuum_probes_.empty()) return;
  std::vector<std::string> columns{"time [s]"};
  for (const auto* names : {&dem_probes_, &continuum_probes_})
    for (const std::string& name : *names)
      for (const char* axis : {"x", "y", "z"}) columns.push_back(name + "." + axis + " [m]");
  probes_ = std::make_unique<History>(folder_.history("probes.csv", columns));
}

void Recorder::monitor(const std::string& stage, std::uint64_t step, double time, double dt, const Advance& advance,
                       double steps_per_second) {
  double unbalanced = 0.0, speed = 0.0, interface_motion = 0.0;
  std::array<double, 7> momentum{};  // linear, angular, sum of m |v|
  for (const auto* report : {&advance.dem, &advance.continuum})
    if (*report) {
      unbalanced = std::max(unbalanced, (*report)->unbalanced);
      speed = std::max(speed, (*report)->largest_speed);
      interface_motion = std::max(interface_motion, (*report)->largest_displacement);
      for (std::size_t k = 0; k < momentum.size(); ++k) momentum[k] += (*report)->momentum[k];
    }
  if (!monitor_)
    monitor_ = std::make_unique<History>(folder_.history(
        "monitor.csv", {"step", "time [s]", "dt [s]", "unbalanced", "largest speed [m/s]", "interface displacement [m]", "steps per second",
                        "momentum.x [kg m/s]", "momentum.y [kg m/s]", "momentum.z [kg m/s]", "angular.x [kg m2/s]", "angular.y [kg m2/s]",
                        "angular.z [kg m2/s]", "sum of m v [kg m/s]"}));
  std::vector<double> row{static_cast<double>(step), time, dt, unbalanced, speed, interface_motion, steps_per_second};
  row.insert(row.end(), momentum.begin(), momentum.end());
  monitor_->append(row);
  if (scene_.run.measure_energy) {
    std::vector<double> row = energy_.add(advance.dem, advance.continuum);
    row.insert(row.begin(), time - advance.ledger_age * dt);  // the ledger is that of a step's beginning
    if (!energy_rows_) {
      std::vector<std::string> columns = energy_.columns();
      columns.insert(columns.begin(), "time [s]");
      energy_rows_ = std::make_unique<History>(folder_.history("energy.csv", columns));
    }
    energy_rows_->append(row);
  }
  probe_rows(time, step, dt, advance);
  reaction_row(time, advance);
  if (advance.dem) {
    if (!counters_) {
      std::vector<std::string> columns{"time [s]"};
      columns.insert(columns.end(), advance.dem->counter_names.begin(), advance.dem->counter_names.end());
      counters_ = std::make_unique<History>(folder_.history("counters.csv", columns));
    }
    std::vector<double> row{time};
    row.insert(row.end(), advance.dem->counters.begin(), advance.dem->counters.end());
    counters_->append(row);
  }
  (void)stage;
}

void Recorder::probe_rows(double time, std::uint64_t step, double dt, const Advance& advance) {
  if (!probes_) return;
  const auto* reference = advance.dem && !dem_probes_.empty() ? &*advance.dem : (advance.continuum ? &*advance.continuum : nullptr);
  if (!reference) return;
  for (std::size_t s = 0; s < reference->probe_steps.size(); ++s) {
    // the sample of step k is taken before the drift: time t_k
    std::vector<double> row{time - (static_cast<double>(step) - reference->probe_steps[s]) * dt};
    const auto take = [&](const std::optional<protocol::RunDone>& report, const std::vector<std::string>& names) {
      if (!report) return;
      for (std::size_t p = 0; p < 3 * names.size(); ++p) row.push_back(report->probes[s * 3 * names.size() + p]);
    };
    take(advance.dem, dem_probes_);
    take(advance.continuum, continuum_probes_);
    const std::size_t columns = row.size() - 1;
    if (zeroed_probes_.empty()) zeroed_probes_.assign(columns, 0.0);
    if (zero_probes_) zeroed_probes_.assign(row.begin() + 1, row.end());
    zero_probes_ = false;
    for (std::size_t k = 0; k < columns; ++k) {
      const double value = row[k + 1] -= zeroed_probes_[k];
      const std::size_t probe = k / 3, axis = k % 3;
      auto& figure = probe_figures_[probe < dem_probes_.size() ? dem_probes_[probe] : continuum_probes_[probe - dem_probes_.size()]];
      if (std::fabs(value) > std::fabs(figure[axis])) figure[axis] = value;
      if (axis == 2) figure[3] = value;
    }
    if (row[0] < next_probe_ - 0.5 * dt) continue;
    next_probe_ += scene_.output.probe_every;
    probes_->append(row);
  }
}

void Recorder::reaction_row(double time, const Advance& advance) {
  std::vector<std::string> columns{"time [s]"};
  std::vector<double> row{time};
  const auto take = [&](const std::optional<protocol::RunDone>& report, const std::string& medium) {
    if (!report) return;
    for (std::size_t g = 0; g < report->reaction_names.size(); ++g)
      for (int axis = 0; axis < 3; ++axis) {
        columns.push_back(medium + " " + report->reaction_names[g] + "." + "xyz"[axis] + " [N]");
        row.push_back(report->reactions[3 * g + static_cast<std::size_t>(axis)]);
      }
  };
  take(advance.dem, "grains");
  take(advance.continuum, "continuum");
  if (columns.size() == 1) return;
  if (!reactions_ || reactions_->columns() != columns) {
    // the groups of a later stage may differ: they go to a file of their own
    static constexpr const char* base = "reactions";
    std::string name = std::string(base) + ".csv";
    for (int n = 2; std::filesystem::exists(folder_.file(name)); ++n) name = std::string(base) + "-" + std::to_string(n) + ".csv";
    reactions_ = std::make_unique<History>(folder_.history(name, columns));
  }
  reactions_->append(row);
}

void Recorder::block_shape(const PlacedBlock& block) {
  block_vertices_ = flat(block.vertices, scene_.origin);
  results_.write_block_geometry({block_vertices_, block.face_ptr, block.face_vertices});
}

void Recorder::block_row(double time, const PlacedBlock& block, const std::vector<double>& state, const std::vector<double>& forces,
                         std::uint64_t steps) {
  constexpr std::size_t velocity = 3, spin = 10, force = 13, torque = 16, corners = 19;
  block_vertices_.assign(state.begin() + corners, state.end());
  double lowest = scene::infinity;
  for (std::size_t k = 2; k < block_vertices_.size(); k += 3) lowest = std::min(lowest, block_vertices_[k]);
  for (std::size_t k = 0; k < block_vertices_.size(); ++k) block_vertices_[k] += scene_.origin[k % 3];
  if (!block_)
    block_ = std::make_unique<History>(folder_.history(
        "block.csv", {"time [s]", "penetration [m]", "velocity.x [m/s]", "velocity.y [m/s]", "velocity.z [m/s]", "force.x [N]", "force.y [N]",
                      "force.z [N]", "spin.x [rad/s]", "spin.y [rad/s]", "spin.z [rad/s]", "torque.x [N m]", "torque.y [N m]", "torque.z [N m]", "force_mean.z [N]",
                      "force_largest.z [N]"}));
  // of the steps since the row before
  const std::size_t count = std::min<std::size_t>(steps, forces.size() / 3);
  double sum = 0.0, largest = 0.0;
  for (std::size_t k = forces.size() - 3 * count; k < forces.size(); k += 3) {
    sum += forces[k + 2];
    if (std::fabs(forces[k + 2]) > std::fabs(largest)) largest = forces[k + 2];
  }
  const double mean = sum / static_cast<double>(std::max<std::size_t>(1, count)), penetration = block.surface_level - lowest;
  impact_.add(time, penetration, -state[velocity + 2], mean, largest);
  std::vector<double> row{time, penetration};
  for (const std::size_t start : {velocity, force, spin, torque})
    for (std::size_t axis = 0; axis < 3; ++axis) row.push_back(state[start + axis]);
  row.insert(row.end(), {mean, largest});
  block_->append(row);
}

void Recorder::state(const std::string& stage, std::uint64_t step, double time, double dt, EngineLink* dem,
                     EngineLink* continuum, const InterfaceTie* tie) {
  last_state_step_ = step;
  results_.begin_state(time, step, stage);
  std::vector<double> u_grains, u_nodes;
  if (dem) {
    u_grains = dem->fetch("displacement");
    count_ejecta(u_grains);
    results_.grain_field("displacement", less(u_grains, zeroed_grains_), 3, "m");
    if (!zeroed_grains_.empty()) results_.grain_field("zeroed_displacement", zeroed_grains_, 3, "m");
    for (const FieldOf& f : grain_fields) results_.grain_field(f.name, dem->fetch(f.name), f.components, f.unit);
    if (damage_) results_.grain_field("damage", *damage_, 1, "");
    if (wants("rotation")) results_.grain_field("rotation", dem->fetch("rotation"), 3, "rad");
    if (wants("contact_force")) results_.contacts(dem->fetch("contact"));
  }
  if (continuum) {
    u_nodes = continuum->fetch("displacement");
    results_.node_field("displacement", less(u_nodes, zeroed_nodes_), 3, "m");
    if (!zeroed_nodes_.empty()) results_.node_field("zeroed_displacement", zeroed_nodes_, 3, "m");
    for (const FieldOf& f : node_fields) results_.node_field(f.name, continuum->fetch(f.name), f.components, f.unit);
    for (const FieldOf& f : cell_fields) results_.cell_field(f.name, continuum->fetch(f.name), f.components, f.unit);
    if (wants("strain")) results_.cell_field("strain", continuum->fetch("strain"), 6, "");
  }
  if (tie) interface_fields(dt, *continuum, *tie, u_grains, u_nodes);
  if (!block_vertices_.empty()) results_.block_vertices(block_vertices_);
  results_.end_state();
}

/// Ejected: a grain of which nothing is within a mean diameter of the surface.
void Recorder::count_ejecta(const std::vector<double>& displacement) {
  if (thrown_.empty()) return;
  const GrainSet& grains = assembly_.grains;
  const double mean_diameter = 2.0 * std::accumulate(grains.radius.begin(), grains.radius.end(), 0.0) / static_cast<double>(thrown_.size());
  in_flight_ = 0;
  for (std::size_t g = 0; g < thrown_.size(); ++g) {
    const double height = grains.position[g][2] + displacement[3 * g + 2] - surface_level_;
    if (height - grains.radius[g] < mean_diameter) continue;
    thrown_[g] = 1;
    ++in_flight_;
  }
}

bool Recorder::wants(const char* field) const {
  return std::find(scene_.output.fields.begin(), scene_.output.fields.end(), field) != scene_.output.fields.end();
}

/// Per row of the tie: gap rows say it directly; for slaved grains the tie's force on the node, and the mean of what
/// the grains that lean on it are ahead of the mesh.
void Recorder::interface_fields(double dt, EngineLink& continuum, const InterfaceTie& tie, const std::vector<double>& u_grains,
                                const std::vector<double>& u_nodes) {
  const InterfaceRows& rows = tie.rows();
  const bool gap = rows.kind == InterfaceRows::Kind::gap;
  if (wants("multiplier")) {
    std::vector<double> force(3 * rows.slots, 0.0);
    if (gap) {
      const std::span<const double> impulse = tie.last_answer();
      for (std::size_t k = 0; k < force.size(); ++k) force[k] = impulse[k] / dt;
    } else {
      const std::vector<double> on_nodes = continuum.fetch("tie_force");
      for (std::size_t r = 0; r < rows.slots; ++r)
        for (std::size_t axis = 0; axis < 3; ++axis) force[3 * r + axis] = -on_nodes[3 * static_cast<std::size_t>(rows.tied_nodes[r]) + axis];
    }
    results_.interface_field("multiplier_force", force, 3, "N");
  }
  if (!wants("jump")) return;
  std::vector<double> jump(3 * rows.slots, 0.0), weight(rows.slots, 0.0);
  if (gap) {
    for (std::size_t r = 0; r < rows.slots; ++r) {
      const Point grains = row_times(rows.grains, r, u_grains), nodes = row_times(rows.nodes, r, u_nodes);
      for (std::size_t axis = 0; axis < 3; ++axis) jump[3 * r + axis] = -(grains[axis] + nodes[axis]);
    }
  } else {
    std::vector<double> u_slots(3 * rows.slots);
    for (std::size_t r = 0; r < rows.slots; ++r)
      for (std::size_t axis = 0; axis < 3; ++axis) u_slots[3 * r + axis] = u_nodes[3 * static_cast<std::size_t>(rows.tied_nodes[r]) + axis];
    for (std::size_t t = 0; t < rows.tied_grains.size(); ++t) {
      const Point mesh = row_times(rows.grains, t, u_slots);
      for (std::int32_t k = rows.grains.row_ptr[t]; k < rows.grains.row_ptr[t + 1]; ++k) {
        const auto slot = static_cast<std::size_t>(rows.grains.columns[static_cast<std::size_t>(k)]);
        const double share = std::fabs(rows.grains.values[static_cast<std::size_t>(k)]);
        weight[slot] += share;
        for (std::size_t axis = 0; axis < 3; ++axis)
          jump[3 * slot + axis] += share * (u_grains[3 * static_cast<std::size_t>(rows.tied_grains[t]) + axis] - mesh[axis]);
      }
    }
    for (std::size_t r = 0; r < rows.slots; ++r)
      for (std::size_t axis = 0; axis < 3; ++axis) jump[3 * r + axis] /= weight[r];
  }
  results_.interface_field("jump", jump, 3, "m");
}

void Recorder::interface_geometry(const InterfaceTie& tie) { results_.write_interface_geometry(flat(tie.rows().slot_position, scene_.origin)); }

void Recorder::zero_displacements(EngineLink* dem, EngineLink* continuum) {
  if (dem) zeroed_grains_ = dem->fetch("displacement");
  if (continuum) zeroed_nodes_ = continuum->fetch("displacement");
  zero_probes_ = true;
  probe_figures_.clear();
}

nlohmann::json Recorder::figures() const {
  nlohmann::json figures = nlohmann::json::object();
  for (const auto& [name, f] : probe_figures_)
    figures[name] = {{"largest_x", f[0]}, {"largest_y", f[1]}, {"largest_z", f[2]}, {"last_z", f[3]}};
  if (!impact_.empty()) {
    const scene::Block& block = *scene_.block;
    double square = 0.0;
    for (const double v : block.velocity) square += v * v;
    figures["block"] = impact_.figures(block_release_, block.mass, -block.velocity[2], 0.5 * block.mass * square, -scene_.gravity[2]);
    figures["ejecta"] = {{"thrown", std::count(thrown_.begin(), thrown_.end(), 1)}, {"in_flight_at_end", in_flight_}};
  }
  return figures;
}

nlohmann::json Recorder::memory() const {
  return {{"energy", energy_.state()}, {"zeroed_grains", zeroed_grains_}, {"zeroed_nodes", zeroed_nodes_}, {"zeroed_probes", zeroed_probes_},
          {"zero_probes", zero_probes_}, {"next_probe", next_probe_}, {"probe_figures", probe_figures_},
          {"impact", impact_.memory()}, {"block_release", block_release_},
          {"surface_level", surface_level_}, {"thrown", thrown_}};
}

void Recorder::remember(const nlohmann::json& memory) {
  energy_.restore(memory.at("energy"));
  memory.at("zeroed_grains").get_to(zeroed_grains_);
  memory.at("zeroed_nodes").get_to(zeroed_nodes_);
  memory.at("zeroed_probes").get_to(zeroed_probes_);
  memory.at("zero_probes").get_to(zero_probes_);
  memory.at("next_probe").get_to(next_probe_);
  memory.at("probe_figures").get_to(probe_figures_);
  impact_.remember(memory.at("impact"));
  memory.at("block_release").get_to(block_release_);
  memory.at("surface_level").get_to(surface_level_);
  memory.at("thrown").get_to(thrown_);
}

void Recorder::close() {
  for (auto* history : {&monitor_, &energy_rows_, &probes_, &reactions_, &counters_, &block_})
    if (*history) (*history)->flush();
  results_.close();
}

}  // namespace gabion::coupler
