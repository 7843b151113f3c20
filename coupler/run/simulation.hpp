#pragma once
// A run from the first message to the summary.

#include <chrono>
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
#include "coupler/run/rates.hpp"
#include "coupler/run/recorder.hpp"
#include "coupler/run/run_failed.hpp"
#include "coupler/run/stepper.hpp"
#include "coupler/run/zone_watch.hpp"

namespace gabion::coupler {

/// The scene asks for something that cannot be run as it stands: exit code 2, with what to do.
struct ScenarioError : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// The user stopped the run; what was written can be read.
struct Interrupted : std::runtime_error {
  using std::runtime_error::runtime_error;
};

class Simulation {
 public:
  /// Links may be null where the model does without them.
  Simulation(const scene::Scene& scene, const std::string& scene_hash, RunFolder& folder, EngineLink* dem, EngineLink* continuum,
             Activity& activity);

  /// Everything; the summary is returned and written as summary.json. Throws the errors above and the protocol's.
  nlohmann::json run();
  /// Makes run() go on from a checkpoint (read_checkpoint) of the same scene; to be called before it.
  void resume_from(nlohmann::json checkpoint) { resumed_ = std::move(checkpoint); }
  /// Where a run that has failed can be taken up again; empty: nowhere.
  const std::string& last_checkpoint() const { return last_checkpoint_; }
  /// A flag that ends the run, with Interrupted, between two chunks of steps.
  void stop_when(const volatile std::sig_atomic_t* flag) { stop_ = flag; }
  /// True once a step was taken.
  bool began() const { return stepper_ && stepper_->step() > 0; }

 private:
  void prepare();
  void place_probes();
  void apply_faces(std::size_t index, double start);
  void begin_stage(std::size_t index);
  void run_stage(const scene::Stage& stage);
  double choose_step(const scene::Stage& stage);
  void choose_rates(const scene::Stage& stage, double dt);
  std::uint64_t whole_periods(std::uint64_t steps) const;
  double stable_step();
  void set_step(double dt);
  PlacedBlock placed_block(const GrainSet& grains) const;
  void release_block();
  void tell_block();
  bool checkpoint_due() const;
  void save_checkpoint();
  /// Brings everything to where the checkpoint was taken; returns the index of its stage.
  std::size_t restore_checkpoint();
  void watch(const scene::Stage& stage, const Advance& advance);
  void look_at_zone(const scene::Stage& stage, std::uint64_t steps, bool last);
  static double tied_damage(const protocol::RunDone& report);
  nlohmann::json summary() const;

  const scene::Scene& scene_;
  std::string scene_hash_;
  RunFolder& folder_;
  EngineLink* dem_;
  EngineLink* continuum_;
  Activity& activity_;
  Log log_;
  const volatile std::sig_atomic_t* stop_ = nullptr;
  Packing packing_;
  Assembly assembly_;
  std::optional<Faces> faces_;
  std::optional<InterfaceTie> tie_;
  std::optional<Recorder> recorder_;
  std::optional<Stepper> stepper_;
  std::optional<Rates> rates_;
  Progress progress_;
  std::vector<double> grain_mass_, node_mass_, grain_weights_;
  double stable_dem_ = 0.0, stable_continuum_ = 0.0, dt_ = 0.0, next_output_ = 0.0;
  Advance last_;
  /// Where the present stage is.
  struct StagePlace {
    std::size_t stage = 0;
    std::uint64_t taken = 0, most = 0, least = 0;  ///< steps: done, at most, before rest is looked for
    double unbalanced = 0.0;
  };
  StagePlace at_;
  nlohmann::json resumed_;  ///< null: a run from the start
  double largest_tied_damage_ = 0.0;
  std::optional<ZoneWatch> zone_watch_;
  std::uint64_t steps_to_look_ = 0;  ///< until the zone is looked at again
  std::uint64_t element_steps_ = 0, grain_steps_ = 0;
  nlohmann::json rates_used_;  ///< of the last stage with several rates; null: none
  double largest_rotation_ = 0.0;  ///< rad, of the interface, where it moved far enough to be looked at
  std::string last_checkpoint_;
  std::chrono::steady_clock::time_point checkpointed_ = std::chrono::steady_clock::now();
  std::optional<PlacedBlock> block_;  ///< once it is released
  nlohmann::json stages_ = nlohmann::json::array();
  std::vector<std::string> warnings_;
  double wall_preparing_ = 0.0;
};

}  // namespace gabion::coupler
