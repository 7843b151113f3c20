#pragma once
// Linear combinations of displacements, sampled during a run.

#include <cstdint>
#include <string>
#include <vector>

#include "protocol/engine/motion.hpp"

namespace gabion::engine {

struct Probes {
  std::vector<std::string> names;
  std::vector<std::int32_t> row_ptr{0}, entities;  ///< CSR: probe p sums coefficients * displacement
  std::vector<double> coefficients;
  std::uint64_t every = 1;  ///< steps between samples

  std::vector<double> sampled_steps;  ///< step numbers since the last take
  std::vector<double> samples;        ///< [samples][probes][3], m

  void sample_if_due(std::uint64_t step, const Motion& motion) {
    if (names.empty() || step % every != 0) return;
    sampled_steps.push_back(static_cast<double>(step));
    for (std::size_t p = 0; p < names.size(); ++p) {
      Vec value{};
      for (std::int32_t k = row_ptr[p]; k < row_ptr[p + 1]; ++k)
        value += splat(coefficients[k]) * motion.displacement[entities[k]];
      for (int axis = 0; axis < 3; ++axis) samples.push_back(value[axis]);
    }
  }
};

}  // namespace gabion::engine
