#pragma once
// What can go wrong while results are written.

#include <stdexcept>
#include <string>

namespace gabion::coupler {

/// The disk, HDF5 or a wrong call: names file, dataset and cause.
struct ResultsError : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// The user's mistake: the run folder cannot be used as asked. Ends the coupler with exit code 2.
struct RunFolderError : std::runtime_error {
  using std::runtime_error::runtime_error;
};

}  // namespace gabion::coupler
