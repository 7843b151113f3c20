#include "dem_server/packing/calibrate.hpp"

#include <cmath>

#include "protocol/engine/engine.hpp"

namespace gabion::dem {
namespace {

/// Measures a packing with unit normal coefficient at any ratio, each solve started from the last one.
class Sample {
 public:
  Sample(BondNetwork network, const Domain& domain, const Window& window, const HomogeniseOptions& options)
      : network_(std::move(network)),
        domain_(domain),
        window_(window),
        options_(options),
        held_(held_grains(network_, domain, options.held_layer)) {}

  Homogenised at_ratio(double ratio) {
    for (Bond& bond : network_.bonds) bond.k_s = ratio * bond.k_n;
    const Equilibrium equilibrium(network_, held_);
    solve_load_cases(equilibrium, options_, cases_);
    return measure(equilibrium, cases_, domain_, window_);
  }

 private:
  BondNetwork network_;
  Domain domain_;
  Window window_;
  HomogeniseOptions options_;
  std::vector<std::uint8_t> held_;
  LoadCases cases_;
};

void check(const CalibrationTarget& target, const CalibrationOptions& options) {
  if (!(target.young > 0.0) || !(target.poisson > -1.0 && target.poisson < 0.5))
    throw engine::RequestError("calibration target",
                               "E " + std::to_string(target.young) + " Pa, nu " + std::to_string(target.poisson),
                               "give E above 0 and nu between -1 and 0.5");
  if (!(options.least_ratio > 0.0 && options.largest_ratio > options.least_ratio))
    throw engine::RequestError("calibration ratio", "the range of k_s/k_n is empty", "give 0 < least < largest");
}

}  // namespace

Calibration calibrate(const VecField& centres, std::span<const double> radii, double gap, const Domain& domain,
                      const Window& window, const CalibrationTarget& target, const CalibrationOptions& options) {
  check(target, options);
  Sample sample(make_bond_network(centres, radii, domain, gap, {{1.0}, {1.0}}), domain, window, options.homogenise);
  Calibration result;
  // How far nu lies above the target; the search runs in the logarithm of the ratio
  const auto miss = [&](double log_ratio) {
    const Homogenised h = sample.at_ratio(std::exp(log_ratio));
    result.trials.push_back({std::exp(log_ratio), h.isotropic.poisson, h.isotropic.young, h.iterations});
    result.misfit = h.isotropic.misfit;
    return h.isotropic.poisson - target.poisson;
  };

  double high = std::log(options.largest_ratio), low = std::log(options.least_ratio);
  double miss_high = miss(high);
  result.poisson_at_largest_ratio = result.trials.back().poisson;
  double miss_low = miss_high < 0.0 ? miss(low) : 0.0;
  if (miss_high < 0.0) result.poisson_at_least_ratio = result.trials.back().poisson;
  result.in_reach = miss_high < 0.0 && miss_low > 0.0;
  int last_side = 0;
  for (int trial = 0; result.in_reach && trial < options.most_trials; ++trial) {
    const double middle = (low * miss_high - high * miss_low) / (miss_high - miss_low);
    const double miss_middle = miss(middle);
    if (std::abs(miss_middle) < options.poisson_tolerance) break;
    const int side = miss_middle > 0.0 ? 1 : -1;
    (side > 0 ? low : high) = middle;
    (side > 0 ? miss_low : miss_high) = miss_middle;
    if (side == last_side) (side > 0 ? miss_high : miss_low) *= 0.5;  // Illinois: free the end that stays
    last_side = side;
  }
  const Calibration::Trial& best = result.trials.back();
  result.normal = target.young / best.young_over_normal;
  result.shear = best.ratio * result.normal;
  result.young = target.young;
  result.poisson = best.poisson;
  return result;
}

}  // namespace gabion::dem
