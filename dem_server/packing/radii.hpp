#pragma once
// Distributions of grain radii.

#include <string>
#include <vector>

#include "dem_server/packing/random.hpp"

namespace gabion::dem {

/// Kinds, with their parameters:
///   uniform  smallest, largest radius [m]; uniform by number; both may be equal
///   sieve    radius [m], share of mass passing, radius, share, ...; radii and shares increasing, shares
///            from 0 to 1; between two sieves the mass is uniform in radius
class RadiusDistribution {
 public:
  /// Throws engine::RequestError with what is wrong.
  RadiusDistribution(const std::string& kind, std::vector<double> parameters);

  /// Radius below which a share u (0 to 1) of the grains lies, by number, m.
  double quantile(double u) const;
  /// Mean volume of a grain, by number, m3.
  double mean_volume() const;
  /// Mean radius, by volume, m.
  double mean_radius_by_volume() const;
  double smallest() const { return smallest_; }
  double largest() const { return largest_; }

 private:
  void read_sieves();
  double sieve_quantile(double u) const;

  std::vector<double> parameters_;
  double smallest_ = 0.0, largest_ = 0.0;
  bool sieve_ = false;
  std::vector<double> cumulative_number_;  ///< sieve: share by number below each radius
  double sieve_mean_volume_ = 0.0, sieve_mean_radius_by_volume_ = 0.0;
};

/// Radii in random order that fill the volume exactly, m. The sample is stratified (one grain per
/// equal share of the distribution), so it scatters less between seeds than independent draws; the
/// rest of the volume goes to as few grains as can take it within the bounds. Only where none can (all
/// radii equal) every radius is scaled by the same factor.
std::vector<double> draw_radii(const RadiusDistribution& distribution, double volume, Random& random);

}  // namespace gabion::dem
