#pragma once
// What a grain is: a sphere of a material.

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numbers>
#include <vector>

#include "dem_server/neighbours.hpp"

namespace gabion::dem {

/// Contact parameters of a material. The stiffness of a grain is the coefficient times its radius.
struct GrainMaterial {
  double normal_stiffness = 0.0;  ///< N/m2, k_n over radius, above 0
  double shear_stiffness = 0.0;   ///< N/m2, k_s over radius, at least 0
  double density = 0.0;           ///< kg/m3, above 0
  double friction = 0.0;          ///< Coulomb coefficient, at least 0, may be infinite
  double normal_strength = 0.0;   ///< N/m2, tensile bond strength over min(r)^2, may be infinite
  double shear_strength = 0.0;    ///< N/m2, shear bond strength over min(r)^2, may be infinite
  // dissipation at frictional contacts, see dissipation.hpp; none by default
  double rolling_stiffness = 0.0;  ///< beta: k_r = beta k_s r_i r_j, at least 0; 0: none
  double rolling_friction = 0.0;   ///< eta: |M| <= eta min(r_i, r_j) N, at least 0, may be infinite; 0: none
  double restitution = 1.0;        ///< of two such grains that collide, above 0 to 1; 1: no dashpots
  bool rotates = true;             ///< false: the grains keep their attitude
  double damping_ratio = 0.0;      ///< of restitution; DemEngine::set_materials fills it in
};

struct Grains {
  std::vector<double> radius;          ///< m
  std::vector<std::int32_t> material;  ///< index into materials
  std::vector<GrainMaterial> materials;

  std::size_t size() const { return radius.size(); }
  const GrainMaterial& material_of(std::size_t i) const { return materials[material[i]]; }
  double plain_mass(std::size_t i) const {
    return material_of(i).density * 4.0 / 3.0 * std::numbers::pi * radius[i] * radius[i] * radius[i];
  }
  double mean_radius() const {
    double total = 0.0;
    for (const double r : radius) total += r;
    return radius.empty() ? 0.0 : total / static_cast<double>(radius.size());
  }
};

/// Stiffness and friction of one contact, weight included; with the half difference of the radii,
/// which places the contact point: a_i = d/2 + half_difference, a_j = d/2 - half_difference.
struct ContactSpring {
  double normal = 0.0;           ///< N/m
  double shear = 0.0;            ///< N/m
  double friction = 0.0;         ///< Coulomb coefficient
  double half_difference = 0.0;  ///< (r_i - r_j)/2, m
};

/// Bond strengths of one contact, weight included.
struct BondStrength {
  double tensile = 0.0;  ///< N
  double shear = 0.0;    ///< N
};

inline double in_series(double a, double b) {
  return a + b > 0.0 ? a * b / (a + b) : 0.0;
}

/// k = w k_i k_j/(k_i + k_j) with k_i = coefficient r_i; the smaller friction.
inline ContactSpring contact_spring(const Grains& grains, std::size_t i, std::size_t j, double weight) {
  const GrainMaterial &a = grains.material_of(i), &b = grains.material_of(j);
  const double ri = grains.radius[i], rj = grains.radius[j];
  return {weight * in_series(a.normal_stiffness * ri, b.normal_stiffness * rj),
          weight * in_series(a.shear_stiffness * ri, b.shear_stiffness * rj), std::min(a.friction, b.friction),
          0.5 * (ri - rj)};
}

/// b = w b_min min(r_i, r_j)^2.
inline BondStrength bond_strength(const Grains& grains, std::size_t i, std::size_t j, double weight) {
  const GrainMaterial &a = grains.material_of(i), &b = grains.material_of(j);
  const double r = std::min(grains.radius[i], grains.radius[j]);
  return {weight * std::min(a.normal_strength, b.normal_strength) * r * r,
          weight * std::min(a.shear_strength, b.shear_strength) * r * r};
}

}  // namespace gabion::dem
