#pragma once
// Contact stiffnesses that give a packing wanted elastic constants. Contact stiffnesses are no material
// constants: they hold for this packing and gap only.
//
// At a fixed ratio k_s/k_n the stiffness of the network is proportional to k_n; Poisson's ratio depends
// on the ratio alone and falls as it grows. So the ratio is searched for nu in one dimension (regula
// falsi, Illinois variant: Dowell & Jarratt 1971), then k_n is scaled for E.

#include <vector>

#include "dem_server/packing/homogenise.hpp"

namespace gabion::dem {

struct CalibrationTarget {
  double young = 0.0;    ///< Pa, above 0
  double poisson = 0.0;  ///< -1 to 0.5
};

struct CalibrationOptions {
  HomogeniseOptions homogenise;
  double least_ratio = 0.01;  ///< of k_s/k_n; below about 0.01 loose packings have next to no stiffness
  double largest_ratio = 1.0;
  double poisson_tolerance = 1e-4;
  int most_trials = 20;
};

struct Calibration {
  double normal = 0.0, shear = 0.0;   ///< coefficients, k over radius of a grain, N/m2
  double young = 0.0, poisson = 0.0;  ///< reached; E always is, nu only within the range of ratios
  double misfit = 0.0;                ///< of the isotropic part
  bool in_reach = true;               ///< false: nu is the one at the nearest end of the range of ratios
  double poisson_at_least_ratio = 0.0, poisson_at_largest_ratio = 0.0;
  struct Trial {
    double ratio, poisson, young_over_normal;
    int iterations;
  };
  std::vector<Trial> trials;  ///< in the order of the search
};

/// One material for all grains. Throws engine::RequestError for targets that make no sense.
Calibration calibrate(const VecField& centres, std::span<const double> radii, double gap, const Domain& domain,
                      const Window& window, const CalibrationTarget& target, const CalibrationOptions& options = {});

}  // namespace gabion::dem
