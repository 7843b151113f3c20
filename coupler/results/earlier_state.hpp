#pragma once
// Grains that begin where another run left them.

#include <cstdint>
#include <filesystem>
#include <vector>

namespace gabion::coupler {

struct EarlierState {
  std::vector<double> displacement;  ///< [n][3] m, from the places at rest, whatever that run zeroed
  std::vector<double> rotation;      ///< [n][3] rad; empty when that run did not store it
};

/// Last state of a results.h5, for the grains with these numbers in the packing, in this order. Throws
/// std::runtime_error (ResultsError among them), with what to do, when the file cannot be read or lacks a grain.
EarlierState read_earlier_state(const std::filesystem::path& file, const std::vector<std::int32_t>& origin);

}  // namespace gabion::coupler
