#pragma once
// The smallest engine there is: points of mass 1, each on a spring of stiffness 1 to its rest position.
// Linked into the protocol's tests and, with a main, an engine that any client can drive.

#include <chrono>
#include <cstring>
#include <thread>

#include "protocol/engine/engine.hpp"
#include "protocol/engine/hash.hpp"

namespace gabion::engine {

class SpringEngine : public Engine {
 public:
  explicit SpringEngine(std::size_t points) : points_(points) { motion.resize(points, false); }

  void prepare() override {
    std::this_thread::sleep_for(slowness);
    motion.resize(points_, options.measure_energy);
    std::fill(motion.mass.begin(), motion.mass.end(), 1.0);
    motion.plain_mass = motion.mass;
  }
  double stable_step() override { return 2.0; }

  bool step(const StepContext& context, Exchange& exchange) override {
    if (throw_at == current_step) throw PhysicsError("point 3", "the spring tore", "take a smaller step");
    for (std::size_t i = 0; i < motion.size(); ++i) motion.force[i] = -motion.displacement[i];
    boundary.add_loads(motion, context);
    motion.trial(0, motion.size(), context);
    boundary.prescribe(motion, context, 0, motion.size());
    bool go_on = true;
    if (tie.mode() != Tie::Mode::none) {
      exchange.send_gap(tie.project(motion, context));
      std::this_thread::sleep_for(slowness);
      if (throw_after_gap == current_step) throw PhysicsError("point 4", "the spring tore late", "");
      go_on = exchange.receive_multipliers(tie.answer_buffer());
      tie.correct(motion, context);
    }
    boundary.book(motion, context);
    motion.drift(context);
    return go_on;
  }

  Ledger ledger() const override {
    Ledger ledger;
    ledger.add("kinetic", Ledger::Kind::stored, motion.kinetic_energy());
    ledger.add("loads", Ledger::Kind::work, boundary.load_work.until_now());
    return ledger;
  }
  std::vector<NamedCount> counters() const override { return {{"points", static_cast<double>(motion.size())}}; }
  double unbalanced() const override { return motion.mean_unbalanced_force(); }

  std::optional<std::vector<double>> field(const std::string& name, std::vector<std::uint64_t>& shape) const override {
    if (name != "displacement") return std::nullopt;
    shape = {motion.size(), 3};
    std::vector<double> values;
    for (const Vec u : motion.displacement) values.insert(values.end(), {u[0], u[1], u[2]});
    return values;
  }
  void set_field(const std::string& name, std::span<const double> values) override {
    VecField* target = name == "displacement" ? &motion.displacement : name == "velocity" ? &motion.velocity : nullptr;
    if (target == nullptr) throw RequestError("SET_FIELD.field", "there is no field '" + name + "'", "");
    if (values.size() != 3 * motion.size()) throw RequestError("SET_FIELD.values", "wrong number of values", "");
    for (std::size_t i = 0; i < motion.size(); ++i)
      (*target)[i] = vec(values[3 * i], values[3 * i + 1], values[3 * i + 2]);
  }
  std::uint64_t state_hash() const override {
    Hash hash;
    hash.add(motion.displacement);
    hash.add(motion.velocity);
    return hash.value();
  }
  std::vector<std::uint8_t> checkpoint() const override {
    std::vector<std::uint8_t> blob(2 * motion.size() * sizeof(Vec));
    std::memcpy(blob.data(), motion.displacement.data(), blob.size() / 2);
    std::memcpy(blob.data() + blob.size() / 2, motion.velocity.data(), blob.size() / 2);
    return blob;
  }
  void restore(std::span<const std::uint8_t> blob) override {
    if (blob.size() != 2 * motion.size() * sizeof(Vec))
      throw RequestError("RESTORE.blob", "the state is not one of this engine", "set the engine up the same way");
    std::memcpy(motion.displacement.data(), blob.data(), blob.size() / 2);
    std::memcpy(motion.velocity.data(), blob.data() + blob.size() / 2, blob.size() / 2);
  }

  std::chrono::milliseconds slowness{0};  ///< of prepare and of each tied step
  std::uint64_t throw_at = UINT64_MAX, throw_after_gap = UINT64_MAX;

 private:
  std::size_t points_;
};

}  // namespace gabion::engine
