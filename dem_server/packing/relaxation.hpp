#pragma once
// Removes overlaps of frictionless soft spheres by FIRE.
//
// Bitzek, Koskinen, Gaehler, Moseler, Gumbsch, Phys. Rev. Lett. 97, 170201 (2006), with semi-implicit
// Euler:  P = f.v;  v <- (1-alpha) v + alpha |v| f/|f|;  P > 0 for n_min steps: dt grows, alpha falls;
//         P <= 0: v = 0, dt halves, alpha starts again.
//
// Repulsion f = (s(r_i + r_j) - |x_j - x_i|)+ along the line of centres, s the scale of the radii: unit
// stiffness and unit mass (heavier for large grains, which have many contacts), so time has no unit and
// forces are lengths [m]. Flat faces are rigid: centres never come nearer than s r.

#include <cstddef>
#include <span>
#include <vector>

#include "dem_server/neighbours.hpp"
#include "protocol/engine/vec.hpp"

namespace gabion::dem {

struct RelaxationLimits {
  int steps = 1000;          ///< at most
  double overlap = 1e-6;     ///< done when the mean overlap of touching grains over the mean radius is below
  double unbalanced = 1e-4;  ///< or when the rms force on a grain over the rms contact force is below
};

struct RelaxationOutcome {
  int steps = 0;
  std::size_t touching = 0;   ///< pairs that overlap
  double mean_overlap = 0.0;  ///< of touching pairs over the mean radius
  double max_overlap = 0.0;   ///< over the mean radius
  double unbalanced = 0.0;    ///< rms force on a grain over rms contact force
};

class Relaxation {
 public:
  /// centres [m] are moved in place; both fields must outlive this.
  Relaxation(engine::VecField& centres, std::span<const double> radii, const Domain& domain);

  /// Relaxes with the radii times scale.
  RelaxationOutcome run(double scale, const RelaxationLimits& limits);

 private:
  struct Neighbour {
    std::int32_t i, j;
    double reach;       ///< r_i + r_j at full size, m
    engine::Vec shift;  ///< of j by its periods, m
  };

  /// Puts centres back into the box in periodic directions.
  void wrap();
  void search(double scale);
  void evaluate_forces(double scale, RelaxationOutcome& outcome);
  /// Forces into a flat face that holds the grain do not count.
  void support(double scale);
  void advance(double dt, double scale);
  double drifted() const;

  engine::VecField& centres_;
  std::span<const double> radii_;
  Domain domain_;
  double mean_radius_ = 0.0;
  double margin_ = 0.0;  ///< of the neighbour list, m
  double searched_scale_ = 0.0;
  std::vector<Neighbour> neighbours_;
  std::vector<double> inverse_mass_;
  engine::VecField searched_, velocity_, force_;
};

}  // namespace gabion::dem
