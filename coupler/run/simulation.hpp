#pragma once
// A run from the first message to the summary.

#include <csignal>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>

#include "coupler/ground/block.hpp"
#include "coupler/results/run_folder.hpp"
#include "coupler/run/faces.hpp"
#include "coupler/run/interface_tie.hpp"
#include "coupler/run/preparation.hpp"
#include "coupler/run/progress.hpp"
#include "coupler/run/recorder.hpp"
#include "coupler/run/stepper.hpp"

namespace gabion::coupler {

/// The scene asks for something that cannot be run as it stands: exit code 2, with what to do.
struct ScenarioError : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// The physics went wrong: energy, unbalanced force that does not fall, too large a rotation. Exit code 3.
struct RunFailed : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// The user stopped the run; what was written can be read.
struct Interrupted : std::runtime_error {
  using std::runtime_error::runtime_error;
};

class Simulation {
 public:
  /// Links may be null where the model does without them.
  Simulation(const scene::Scene& scene, RunFolder& folder, EngineLink* dem, EngineLink* continuum);

  /// Everything; the summary is returned and written as summary.json. Throws the errors above and the protocol's.
  nlohmann::json run();
  /// A flag that ends the run, with Interrupted, between two chunks of steps.
  void stop_when(const volatile std::sig_atomic_t* flag) { stop_ = flag; }
  /// True once a step was taken.
  bool began() const { return stepper_ && stepper_->step() > 0; }

 private:
  void prepare();
  void place_probes();
  void run_stage(const scene::Stage& stage);
  double choose_step(const scene::Stage& stage);
  double stable_step();
  void set_step(double dt);
  PlacedBlock placed_block(const GrainSet& grains) const;
  void release_block();
  void watch(const scene::Stage& stage, const Advance& advance);
  nlohmann::json summary() const;

  const scene::Scene& scene_;
  RunFolder& folder_;
  EngineLink* dem_;
  EngineLink* continuum_;
  Log log_;
  const volatile std::sig_atomic_t* stop_ = nullptr;
  Packing packing_;
  Assembly assembly_;
  std::optional<Faces> faces_;
  std::optional<InterfaceTie> tie_;
  std::optional<Recorder> recorder_;
  std::optional<Stepper> stepper_;
  Progress progress_;
  std::vector<double> grain_mass_, node_mass_, grain_weights_;
  double stable_dem_ = 0.0, stable_continuum_ = 0.0, dt_ = 0.0, next_output_ = 0.0;
  Advance last_;
  std::optional<PlacedBlock> block_;  ///< once it is released
  nlohmann::json stages_ = nlohmann::json::array();
  std::vector<std::string> warnings_;
  double wall_preparing_ = 0.0;
};

}  // namespace gabion::coupler
