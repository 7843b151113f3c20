#pragma once
// How often the continuum's elements are evaluated: rates of mesh.rates (HexMesh::level), cut to what the step allows.

#include <cstdint>
#include <optional>
#include <vector>

#include "coupler/ground/mesh.hpp"
#include "coupler/run/engine_link.hpp"

namespace gabion::coupler {

class Rates {
 public:
  /// All elements at rate 1. wanted: absent where the scene or the model has no use for several rates.
  Rates(const std::optional<scene::Rates>& wanted, const HexMesh& mesh, EngineLink* continuum);

  /// Everything of the run happens at multiples of this many steps; 1 where all elements keep one rate.
  std::uint64_t period() const { return period_; }
  /// Largest rate now.
  std::uint64_t largest() const { return largest_; }
  /// Whether mesh.rates.largest is a number, which then must fit.
  bool fixed() const { return wanted_ && wanted_->largest > 0; }

  /// Before the first step, with the step of an undamped stage, s: decides on the period.
  void plan(double dt);
  /// The largest rate up to the period whose elements are stable at a step of dt, s; the engine keeps it.
  std::uint64_t fit(double dt);
  /// Tells the engine to cut the rates at this one; 1: all take every step. Also for a run that goes on, with its period.
  void cut(std::uint64_t largest);
  void resume(std::uint64_t period, std::uint64_t largest);

  /// Step of a node over that of the run.
  double node_rate(std::size_t node) const;
  /// Evaluations of elements in so many steps of the run.
  std::uint64_t element_steps(std::uint64_t steps) const;
  /// Elements of each rate, from 1 in powers of two up to the largest.
  std::vector<std::size_t> elements() const;

 private:
  std::uint64_t rate(std::size_t element) const;
  std::uint64_t fit(double dt, std::uint64_t most);

  std::optional<scene::Rates> wanted_;
  const HexMesh& mesh_;
  EngineLink* continuum_;
  std::uint64_t period_ = 1, largest_ = 1;
  std::vector<std::uint8_t> node_level_;  ///< smallest of its elements'
};

}  // namespace gabion::coupler
