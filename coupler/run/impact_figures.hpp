#pragma once
// What an impact comes to: the figures that studies of rockfall quote, from the block's history.
//
//   F4(t)  mean of the vertical force over 4 ms round t, from the impulse, so that nothing falls between rows [N]
//   S      F4max X/(E + m g X), X the final penetration, E the kinetic energy at release: 1 for a constant force, 2 for
//          one that grows with the penetration
//   stop   last time at which the block goes down faster than 5 % of its speed at release: what follows is creep;
//          first stop: the first time at which it no longer does, before it may roll over or sink on

#include <nlohmann/json.hpp>
#include <vector>

namespace gabion::coupler {

class ImpactFigures {
 public:
  /// time s; penetration m; speed downwards m/s; mean and largest vertical force since the row before, N, upwards.
  void add(double time, double penetration, double speed, double mean_force, double largest_force);
  bool empty() const { return time_.empty(); }

  /// release: time of release, s; mass kg; speed at release, downwards, m/s; kinetic energy then, J; gravity m/s2.
  /// Names with their unit in docs/results.md; what the history is too short for is left out.
  nlohmann::json figures(double release, double mass, double speed, double energy, double gravity) const;

  /// For checkpoints.
  nlohmann::json memory() const;
  void remember(const nlohmann::json& memory);

 private:
  std::vector<double> time_, penetration_, speed_, mean_force_;
  double largest_force_ = 0.0;  ///< N
};

}  // namespace gabion::coupler
