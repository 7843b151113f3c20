// Requests that mean the same to grains and nodes.

#include <cmath>

#include "protocol/session/service.hpp"

namespace gabion::protocol {

namespace {

using engine::RequestError;

engine::Vec to_vec(std::span<const double> v) {
  return engine::vec(v[0], v[1], v[2]);
}

engine::VecField to_field(const Array<double>& rows) {
  engine::VecField field(rows.rows());
  for (std::size_t i = 0; i < field.size(); ++i) field[i] = to_vec(rows.row(i));
  return field;
}

void need_finite(const Array<double>& values, const char* field) {
  for (const double value : values)
    if (!std::isfinite(value)) throw RequestError(field, "a value is " + std::to_string(value), "send finite numbers");
}

engine::Options to_options(const Options& m) {
  need_finite(m.gravity, "OPTIONS.gravity");
  engine::Options options;
  options.gravity = to_vec(m.gravity.data);
  options.box_lo = to_vec(m.box_lo.data);
  options.box_hi = to_vec(m.box_hi.data);
  for (int axis = 0; axis < 3; ++axis) options.periodic[axis] = m.periodic[axis] != 0;
  options.measure_energy = m.measure_energy != 0;
  return options;
}

engine::WeightField to_weights(const Weights& m) {
  if (!(m.width >= 0.0 && std::isfinite(m.width)))
    throw RequestError("WEIGHTS.width", "the width is " + std::to_string(m.width), "send 0 (no weights) or more");
  if (!(m.floor >= 0.0 && m.floor <= 1.0))
    throw RequestError("WEIGHTS.floor", "the floor is " + std::to_string(m.floor), "send 0 to 1");
  for (int axis = 0; axis < 3; ++axis)
    if (std::isnan(m.outer_lo[axis]) || std::isnan(m.outer_hi[axis]))
      throw RequestError("WEIGHTS.outer_lo", "a coordinate is not a number", "send infinity where there is no face");
  return {to_vec(m.outer_lo.data), to_vec(m.outer_hi.data), m.width, m.floor};
}

engine::Probes to_probes(Probes&& m, std::size_t points) {
  engine::Probes probes;
  if (m.row_ptr.empty()) m.row_ptr = std::vector<std::int32_t>{0};
  const auto& ptr = m.row_ptr.data;
  if (ptr.size() != m.names.size() + 1 || ptr.front() != 0 || static_cast<std::size_t>(ptr.back()) != m.entities.size())
    throw RequestError("PROBES.row_ptr",
                       "it does not fit " + std::to_string(m.names.size()) + " names and " +
                           std::to_string(m.entities.size()) + " entities",
                       "send one start a probe, from 0, and the end");
  for (std::size_t p = 0; p + 1 < ptr.size(); ++p)
    if (ptr[p] > ptr[p + 1]) throw RequestError("PROBES.row_ptr", "it decreases at probe " + std::to_string(p), "");
  for (const std::int32_t e : m.entities)
    if (e < 0 || static_cast<std::size_t>(e) >= points)
      throw RequestError("PROBES.entities",
                         "entity " + std::to_string(e) + " of " + std::to_string(points) + " does not exist", "");
  if (m.every == 0) throw RequestError("PROBES.every", "0 steps between samples", "send 1 or more");
  need_finite(m.coefficients, "PROBES.coefficients");
  probes.names = std::move(m.names);
  probes.row_ptr = std::move(m.row_ptr.data);
  probes.entities = std::move(m.entities.data);
  probes.coefficients = std::move(m.coefficients.data);
  probes.every = m.every;
  return probes;
}

void set_tie(engine::Engine& engine, Tie&& m) {
  if (m.mode == "none") return engine.tie.clear();
  if (m.mode != "gap" && m.mode != "slave")
    throw RequestError("TIE.mode", "unknown mode '" + m.mode + "'", "known: none, gap, slave");
  need_finite(m.values, "TIE.values");
  if (m.row_ptr.empty()) m.row_ptr = std::vector<std::int32_t>{0};
  const auto mode = m.mode == "gap" ? engine::Tie::Mode::gap : engine::Tie::Mode::slave;
  engine.tie.set(mode, m.slots, std::move(m.tied.data), std::move(m.row_ptr.data), std::move(m.columns.data),
                 std::move(m.values.data), engine.motion);
}

Field fetch(const engine::Engine& engine, const std::string& name, const std::vector<std::string>& capabilities) {
  std::vector<std::uint64_t> shape;
  auto values = engine.field(name, shape);
  if (!values) {
    std::string known;
    for (const std::string& capability : capabilities)
      if (capability.starts_with("field:")) known += (known.empty() ? "" : ", ") + capability.substr(6);
    throw RequestError("FETCH.field", "there is no field '" + name + "'", "known: " + known);
  }
  Field field;
  field.field = name;
  field.values.set_shape(shape);
  field.values.data = std::move(*values);
  return field;
}

}  // namespace

void Service::add_shared_messages() {
  const auto points = [this] { return engine_.motion.size(); };
  on<Options>([this](const Options& m) {
    engine_.options = to_options(m);
    return Ok{};
  });
  on<Weights>([this](const Weights& m) {
    engine_.weights = to_weights(m);
    return Ok{};
  });
  on<Constrain>([this, points](Constrain&& m) {
    need_finite(m.direction, "CONSTRAIN.direction");
    engine_.boundary.add(engine::Constraint{m.name, std::move(m.entities.data), m.components, to_vec(m.direction.data),
                                            engine::History(m.history_kind, std::move(m.history.data))},
                         points());
    return Ok{};
  });
  on<Loads>([this, points](Loads&& m) {
    need_finite(m.vectors, "LOADS.vectors");
    engine_.boundary.add(engine::Load{m.name, std::move(m.entities.data), to_field(m.vectors),
                                      engine::History(m.history_kind, std::move(m.history.data))},
                         points());
    return Ok{};
  });
  on<Dashpots>([this, points](Dashpots&& m) {
    need_finite(m.coefficients, "DASHPOTS.coefficients");
    engine_.boundary.add(engine::Dashpot{m.name, std::move(m.entities.data), to_field(m.coefficients)}, points());
    return Ok{};
  });
  on<Probes>([this, points](Probes&& m) {
    engine_.probes = to_probes(std::move(m), points());
    return Ok{};
  });
  on<Prepare>([this](const Prepare&) {
    state_ = SessionState::configuring;  // stays there when preparing fails
    engine_.prepare();
    Ready ready = ready_message();
    state_ = SessionState::ready;
    run_failed_ = false;
    return ready;
  });
  on<StableStep>([this](const StableStep&) { return ready_message(); });
  on<Tie>([this](Tie&& m) {
    set_tie(engine_, std::move(m));
    return Ok{};
  });
  on<Fetch>([this](const Fetch& m) { return fetch(engine_, m.field, capabilities_); });
  on<SetField>([this](const SetField& m) {
    need_finite(m.values, "SET_FIELD.values");
    engine_.set_field(m.field, m.values.data);
    return Ok{};
  });
  on<Checkpoint>([this](const Checkpoint&) {
    protocol::State state;
    state.blob = engine_.checkpoint();
    checkpoint_step_ = engine_.current_step;
    return state;
  });
  on<Restore>([this](const Restore& m) {
    engine_.restore(m.blob.data);
    run_failed_ = false;
    return Ok{};
  });
  on<Run>([this](const Run& m) { return run(m); });
  on<Bye>([this](const Bye&) {
    state_ = SessionState::closed;
    return Ok{};
  });
}

Ready Service::ready_message() {
  Ready ready;
  ready.mass = engine_.motion.mass;
  ready.plain_mass = engine_.motion.plain_mass;
  ready.stable_step = engine_.stable_step();
  ready.highest_frequency = 2.0 / ready.stable_step;
  return ready;
}

}  // namespace gabion::protocol
