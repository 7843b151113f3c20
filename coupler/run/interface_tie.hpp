#pragma once
// The interface of a run: rows built once, sent to both engines, multipliers refactored when masses, step or
// constraints change.

#include <memory>

#include "coupler/interface/multipliers.hpp"
#include "coupler/run/assembly.hpp"
#include "coupler/run/engine_link.hpp"

namespace gabion::coupler {

class InterfaceTie {
 public:
  /// Builds the rows and sends TIE to both. Throws std::runtime_error when nothing can be tied.
  InterfaceTie(const scene::Scene& scene, const Assembly& assembly, EngineLink& dem, EngineLink& continuum);

  /// Factors the multiplier matrix for these masses and constraints; sends the sponge for this step size.
  /// absorb: in a stage that comes to rest by damping the sponge has nothing to do and would only hold grains up.
  void set_step(double dt, const Inertia& grains, const Inertia& nodes, const std::vector<double>& grain_weights, bool absorb);

  /// One step: both gaps to one answer, [slots][3], valid until the next call.
  std::span<const double> solve(std::span<const double> from_grains, std::span<const double> from_nodes);

  std::size_t slots() const { return rows_.slots; }
  const InterfaceRows& rows() const { return rows_; }
  const Point& scene_origin() const { return scene_.origin; }
  const InterfaceReport& report() const { return multipliers_->report(); }

  /// Force of the multipliers on the continuum and displacement jump per row of the last step, for interface.csv.
  std::span<const double> last_answer() const { return answer_; }

 private:
  void send_tie(EngineLink& link, const SparseRows& rows, const std::vector<std::int32_t>& tied);
  void send_sponge(double dt, const std::vector<double>& grain_weights);
  void remove_sponge();

  const scene::Scene& scene_;
  const Assembly& assembly_;
  EngineLink& dem_;
  InterfaceRows rows_;
  std::unique_ptr<Multipliers> multipliers_;
  std::vector<double> answer_;
  bool absorbs_ = false;  ///< the engine has the sponge
};

}  // namespace gabion::coupler
