#pragma once
// Everything a run writes down, in one folder; docs/results.md lists it.

#include <map>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>

#include "coupler/ground/block.hpp"
#include "coupler/results/results_file.hpp"
#include "coupler/results/run_folder.hpp"
#include "coupler/run/assembly.hpp"
#include "coupler/run/energy.hpp"
#include "coupler/run/impact_figures.hpp"
#include "coupler/run/engine_link.hpp"
#include "coupler/run/interface_tie.hpp"
#include "coupler/run/stepper.hpp"

namespace gabion::coupler {

class Recorder {
 public:
  Recorder(RunFolder& folder, const scene::Scene& scene, const Assembly& assembly,
           const std::vector<double>& grain_weights);

  /// Probe names in the order in which they stand in each engine.
  void set_probes(std::vector<std::string> dem, std::vector<std::string> continuum);

  /// A row of each history; probes hold several samples.
  void monitor(const std::string& stage, std::uint64_t step, double time, double dt, const Advance& advance,
               double steps_per_second);
  /// The fields of both media. dt: for the multiplier force.
  void state(const std::string& stage, std::uint64_t step, double time, double dt, EngineLink* dem,
             EngineLink* continuum, const InterfaceTie* tie);

  /// Stored with each state from now on: largest share of a grain's contacts that slid or were broken so far, [grains].
  void show_damage(const std::vector<double>& damage) { damage_ = &damage; }
  /// Where the rows of the tie act, before the first state.
  void interface_geometry(const InterfaceTie& tie);
  /// The block's shape, before the first state; where it is goes with each state.
  void block_shape(const PlacedBlock& block);
  /// A row of block.csv. state: field "block" of the engine; forces: field "block_forces", of which the last steps count.
  void block_row(double time, const PlacedBlock& block, const std::vector<double>& state, const std::vector<double>& forces,
                 std::uint64_t steps);
  /// The block is released at this time, s, on ground whose mean surface lies at level, m.
  void block_released(double time, double level) {
    block_release_ = time;
    surface_level_ = level;
    thrown_.assign(assembly_.grains.position.size(), 0);
    energy_.body_added();
  }
  /// Step of the last stored state.
  std::uint64_t last_state_step() const { return last_state_step_; }

  /// From now on displacements of states and probes are counted from what they are at this moment.
  void zero_displacements(EngineLink* dem, EngineLink* continuum);
  const EnergyBalance& energy() const { return energy_; }
  /// Largest displacement component of each probe over the run, m, and its last value.
  nlohmann::json figures() const;
  /// For checkpoints: what the next row or state depends on.
  nlohmann::json memory() const;
  void remember(const nlohmann::json& memory);
  void close();

 private:
  void probe_rows(double time, std::uint64_t step, double dt, const Advance& advance);
  void reaction_row(double time, const Advance& advance);
  void interface_fields(double dt, EngineLink& continuum, const InterfaceTie& tie, const std::vector<double>& u_grains,
                        const std::vector<double>& u_nodes);
  bool wants(const char* field) const;
  void count_ejecta(const std::vector<double>& displacement);

  RunFolder& folder_;
  const scene::Scene& scene_;
  const Assembly& assembly_;
  ResultsFile results_;
  EnergyBalance energy_;
  std::unique_ptr<History> monitor_, energy_rows_, probes_, reactions_, counters_, block_;
  std::vector<std::string> dem_probes_, continuum_probes_;
  std::uint64_t last_state_step_ = 0;
  const std::vector<double>* damage_ = nullptr;
  std::vector<double> zeroed_grains_, zeroed_nodes_;        ///< displacements at the last zeroing, m; empty: none
  std::vector<double> zeroed_probes_;                        ///< in the order of the columns
  bool zero_probes_ = false;                                 ///< the next sample becomes the zero
  double next_probe_ = 0.0;
  ImpactFigures impact_;
  double block_release_ = 0.0;          ///< s
  double surface_level_ = 0.0;          ///< at the release, m
  std::vector<std::uint8_t> thrown_;    ///< grains seen above the surface since the release; empty before
  std::size_t in_flight_ = 0;           ///< of the last state
  std::vector<double> block_vertices_;  ///< present corners, m; before its release where it would touch the grains
  std::map<std::string, std::array<double, 4>> probe_figures_;  ///< largest |component| 3, last z
};

}  // namespace gabion::coupler
