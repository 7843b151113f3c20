#pragma once
// What lies inside a box: shares of spheres and of branches.

#include <span>

#include "dem_server/neighbours.hpp"

namespace gabion::dem {

/// A box to measure in. It must lie inside the domain in the periodic directions.
struct Window {
  Vec lo{}, hi{};  ///< m
  double volume() const { return (hi[0] - lo[0]) * (hi[1] - lo[1]) * (hi[2] - lo[2]); }
  bool contains(Vec x) const {
    for (int a = 0; a < 3; ++a)
      if (x[a] < lo[a] || x[a] >= hi[a]) return false;
    return true;
  }
};

/// A window in a domain, which knows where it spans a whole period: there nothing is cut.
class Cutter {
 public:
  /// Throws engine::RequestError when the window is empty or leaves the domain in a periodic direction.
  Cutter(const Window& window, const Domain& domain);

  /// x moved by whole periods into the domain.
  Vec wrapped(Vec x) const;
  bool contains(Vec x) const;
  bool spans(int axis) const { return spans_[axis]; }
  const Window& window() const { return window_; }

  /// Share, 0 to 1, of the straight line from `from` to `from + branch` that lies inside the window or
  /// one of its periodic images.
  double share_of_branch(Vec from, Vec branch) const;

  /// Volume of the sphere inside the window and its periodic images, m3. Exact for spheres that at most
  /// one pair of parallel faces cuts (caps); spheres at edges and corners are cut into 48 x 48 columns,
  /// each with its exact length, to about 1e-3 of the sphere.
  double volume_of_sphere(Vec centre, double radius) const;

 private:
  template <class Measure>
  double over_images(Vec at, Vec reach_lo, Vec reach_hi, Measure measure) const;

  Window window_;
  Domain domain_;
  bool spans_[3] = {false, false, false};
};

/// Volume of the spheres inside the window over the window's volume; overlaps count twice.
double solid_fraction(const VecField& centres, std::span<const double> radii, const Domain& domain,
                      const Window& window);

}  // namespace gabion::dem
