#pragma once
// What ends a run although every process does its work.

#include <stdexcept>

namespace gabion::coupler {

/// The physics went wrong: energy, unbalanced force that does not fall, too large a rotation, a number that is none. Exit
/// code 3.
struct RunFailed : std::runtime_error {
  using std::runtime_error::runtime_error;
};

}  // namespace gabion::coupler
