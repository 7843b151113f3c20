#include "dem_server/packing/window.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "protocol/engine/engine.hpp"

namespace gabion::dem {
namespace {

constexpr int columns = 48;

/// Volume of the unit-free sphere part between two planes at a and b from the centre.
double slab_volume(double radius, double a, double b) {
  const auto below = [radius](double z) {  // pi (R^2 z - z^3/3)
    const double t = std::clamp(z, -radius, radius);
    return std::numbers::pi * (radius * radius * t - t * t * t / 3.0);
  };
  return b > a ? below(b) - below(a) : 0.0;
}

/// Midpoint rule over columns along z; lo and hi are relative to the centre.
double box_volume(double radius, Vec lo, Vec hi) {
  const double x0 = std::max(lo[0], -radius), x1 = std::min(hi[0], radius);
  const double y0 = std::max(lo[1], -radius), y1 = std::min(hi[1], radius);
  if (x0 >= x1 || y0 >= y1) return 0.0;
  const double dx = (x1 - x0) / columns, dy = (y1 - y0) / columns;
  double length = 0.0;
  for (int kx = 0; kx < columns; ++kx) {
    const double x = x0 + (kx + 0.5) * dx;
    for (int ky = 0; ky < columns; ++ky) {
      const double y = y0 + (ky + 0.5) * dy;
      const double half2 = radius * radius - x * x - y * y;
      if (half2 <= 0.0) continue;
      const double half = std::sqrt(half2);
      length += std::max(0.0, std::min(hi[2], half) - std::max(lo[2], -half));
    }
  }
  return length * dx * dy;
}

double sphere_in_box(double radius, Vec lo, Vec hi) {
  int cut_axes = 0, cut_axis = 0;
  for (int a = 0; a < 3; ++a) {
    if (lo[a] >= radius || hi[a] <= -radius) return 0.0;
    if (lo[a] <= -radius && hi[a] >= radius) continue;
    ++cut_axes;
    cut_axis = a;
  }
  if (cut_axes <= 1) return slab_volume(radius, lo[cut_axis], hi[cut_axis]);
  return box_volume(radius, lo, hi);
}

}  // namespace

Cutter::Cutter(const Window& window, const Domain& domain) : window_(window), domain_(domain) {
  constexpr double tolerance = 1e-9;
  for (int a = 0; a < 3; ++a) {
    if (!(window.hi[a] > window.lo[a]))
      throw engine::RequestError("window", "the window is empty along axis " + std::to_string(a),
                                 "give lower corners below upper corners");
    if (!domain.periodic[a]) continue;
    const double slack = tolerance * domain.period(a);
    if (window.lo[a] < domain.lo[a] - slack || window.hi[a] > domain.hi[a] + slack)
      throw engine::RequestError("window", "the window leaves the period along axis " + std::to_string(a),
                                 "keep it inside the box in periodic directions");
    spans_[a] = window.hi[a] - window.lo[a] > domain.period(a) - slack;
  }
}

Vec Cutter::wrapped(Vec x) const {
  for (int a = 0; a < 3; ++a)
    if (domain_.periodic[a]) x[a] -= domain_.period(a) * std::floor((x[a] - domain_.lo[a]) / domain_.period(a));
  return x;
}

bool Cutter::contains(Vec x) const {
  for (int a = 0; a < 3; ++a)
    if (!spans_[a] && (x[a] < window_.lo[a] || x[a] >= window_.hi[a])) return false;
  return true;
}

/// Sum of measure(lo, hi) over the images of the window that [at + reach_lo, at + reach_hi] can meet; lo
/// and hi are relative to at, infinite where the window spans the period.
template <class Measure>
double Cutter::over_images(Vec at, Vec reach_lo, Vec reach_hi, Measure measure) const {
  int first[3] = {0, 0, 0}, last[3] = {0, 0, 0};
  Vec lo = window_.lo - at, hi = window_.hi - at;
  for (int a = 0; a < 3; ++a) {
    if (spans_[a]) {
      lo[a] = -INFINITY;
      hi[a] = INFINITY;
    } else if (domain_.periodic[a]) {
      first[a] = static_cast<int>(std::ceil((reach_lo[a] - hi[a]) / domain_.period(a)));
      last[a] = static_cast<int>(std::floor((reach_hi[a] - lo[a]) / domain_.period(a)));
    }
  }
  double total = 0.0;
  for (int x = first[0]; x <= last[0]; ++x)
    for (int y = first[1]; y <= last[1]; ++y)
      for (int z = first[2]; z <= last[2]; ++z) {
        Vec offset = engine::vec(0.0, 0.0, 0.0);
        const int image[3] = {x, y, z};
        for (int a = 0; a < 3; ++a)
          if (image[a] != 0) offset[a] = image[a] * domain_.period(a);
        total += measure(lo + offset, hi + offset);
      }
  return total;
}

double Cutter::share_of_branch(Vec from, Vec branch) const {
  Vec reach_lo{}, reach_hi{};
  for (int a = 0; a < 3; ++a) {
    reach_lo[a] = std::min(0.0, branch[a]);
    reach_hi[a] = std::max(0.0, branch[a]);
  }
  return over_images(wrapped(from), reach_lo, reach_hi, [branch](Vec lo, Vec hi) {
    double enter = 0.0, leave = 1.0;  // Liang and Barsky's clipping of a line by a box
    for (int a = 0; a < 3; ++a) {
      if (branch[a] == 0.0) {
        if (lo[a] > 0.0 || hi[a] <= 0.0) return 0.0;
        continue;
      }
      const double t0 = lo[a] / branch[a], t1 = hi[a] / branch[a];
      enter = std::max(enter, std::min(t0, t1));
      leave = std::min(leave, std::max(t0, t1));
    }
    return std::max(0.0, leave - enter);
  });
}

double Cutter::volume_of_sphere(Vec centre, double radius) const {
  return over_images(wrapped(centre), engine::splat(-radius), engine::splat(radius),
                     [radius](Vec lo, Vec hi) { return sphere_in_box(radius, lo, hi); });
}

double solid_fraction(const VecField& centres, std::span<const double> radii, const Domain& domain,
                      const Window& window) {
  const Cutter cutter(window, domain);
  double volume = 0.0;
  for (std::size_t i = 0; i < centres.size(); ++i) volume += cutter.volume_of_sphere(centres[i], radii[i]);
  return volume / window.volume();
}

}  // namespace gabion::dem
