#pragma once
// Functions of time for loads and prescribed velocities.

#include <string>
#include <vector>

namespace gabion::engine {

/// Kinds, with their parameters (times in s; values dimensionless or in the unit the user gave):
///   zero       none
///   constant   value
///   ramp       value, start, rise      0 before start, linear to value over rise, then value
///   half_sine  amplitude, start, duration
///   table      t0, v0, t1, v1, ...     linear between, constant outside; t increasing
class History {
 public:
  History() = default;
  /// Throws std::invalid_argument with the kind and what was expected.
  History(const std::string& kind, std::vector<double> parameters);

  double at(double time) const;

 private:
  enum class Kind { zero, constant, ramp, half_sine, table };
  Kind kind_ = Kind::zero;
  std::vector<double> parameters_;
};

}  // namespace gabion::engine
