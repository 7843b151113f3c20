#include "dem_server/packing/bond_network.hpp"

#include <algorithm>

#include "protocol/engine/engine.hpp"

namespace gabion::dem {
namespace {

double in_series(double k_i, double k_j) {
  return k_i + k_j > 0.0 ? k_i * k_j / (k_i + k_j) : 0.0;
}

double of_grain(const std::vector<double>& coefficients, std::int32_t grain) {
  return coefficients.size() == 1 ? coefficients.front() : coefficients[grain];
}

void check(const std::vector<double>& coefficients, std::size_t grains, const char* name) {
  if (coefficients.size() != 1 && coefficients.size() != grains)
    throw engine::RequestError(
        name, std::to_string(coefficients.size()) + " coefficients for " + std::to_string(grains) + " grains",
        "give one, or one for each grain");
  for (const double c : coefficients)
    if (!(c >= 0.0)) throw engine::RequestError(name, "coefficient " + std::to_string(c), "give zero or more");
}

}  // namespace

double BondNetwork::contacts_per_grain() const {
  return centres.empty() ? 0.0 : 2.0 * static_cast<double>(bonds.size()) / static_cast<double>(centres.size());
}

double BondNetwork::mean_radius() const {
  double total = 0.0;
  for (const double r : radii) total += r;
  return radii.empty() ? 0.0 : total / static_cast<double>(radii.size());
}

BondNetwork make_bond_network(const VecField& centres, std::span<const double> radii, const Domain& domain, double gap,
                              const StiffnessCoefficients& coefficients) {
  check(coefficients.normal, radii.size(), "normal_stiffness");
  check(coefficients.shear, radii.size(), "shear_stiffness");
  BondNetwork network{centres, {radii.begin(), radii.end()}, {}, {}};
  const double largest = radii.empty() ? 0.0 : *std::max_element(radii.begin(), radii.end());
  for (const Pair& pair : find_pairs(centres, radii, 2.0 * largest * gap, domain)) {
    const double r_i = radii[pair.i], r_j = radii[pair.j];
    const Vec d = centres[pair.j] + domain.offset(pair.image) - centres[pair.i];
    const double distance = norm(d);
    if (distance > (r_i + r_j) * (1.0 + gap)) continue;
    if (distance == 0.0)
      throw engine::RequestError(
          "grains", "grains " + std::to_string(pair.i) + " and " + std::to_string(pair.j) + " lie at the same place",
          "remove one of them");
    const double half_gap = 0.5 * (distance - r_i - r_j);
    Bond bond{pair.i, pair.j, d / splat(distance), r_i + half_gap, r_j + half_gap, 0.0, 0.0};
    bond.k_n = in_series(of_grain(coefficients.normal, pair.i) * r_i, of_grain(coefficients.normal, pair.j) * r_j);
    bond.k_s = in_series(of_grain(coefficients.shear, pair.i) * r_i, of_grain(coefficients.shear, pair.j) * r_j);
    network.bonds.push_back(bond);
  }
  return network;
}

}  // namespace gabion::dem
