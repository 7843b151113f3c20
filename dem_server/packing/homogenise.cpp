#include "dem_server/packing/homogenise.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "protocol/engine/engine.hpp"

namespace gabion::dem {
namespace {

constexpr int voigt_row[6] = {0, 1, 2, 1, 2, 0};
constexpr int voigt_column[6] = {0, 1, 2, 2, 0, 1};
constexpr std::size_t least_grains = 8;

using Voigt = Eigen::Matrix<double, 6, 1>;

/// Tensor to Voigt vector; shear components as engineering strains (factor 2) or stresses (factor 1).
Voigt to_voigt(const Eigen::Matrix3d& tensor, double shear_factor) {
  Voigt v;
  for (int k = 0; k < 6; ++k)
    v[k] = 0.5 * (tensor(voigt_row[k], voigt_column[k]) + tensor(voigt_column[k], voigt_row[k])) *
           (k < 3 ? 1.0 : shear_factor);
  return v;
}

/// Least-squares gradient of the fluctuations w over the grains in the window; zero along directions
/// that the window spans, over which a periodic field has no mean gradient.
class GradientFit {
 public:
  GradientFit(const BondNetwork& network, const Cutter& cutter) {
    for (std::size_t g = 0; g < network.size(); ++g) {
      const Vec x = cutter.wrapped(network.centres[g]);
      if (cutter.contains(x)) {
        grains_.push_back(g);
        places_.push_back(x);
      }
    }
    if (grains_.size() < least_grains)
      throw engine::RequestError("window", "only " + std::to_string(grains_.size()) + " grains lie in the window",
                                 "enlarge the window or move it into the packing");
    for (const Vec x : places_) mean_ += x;
    mean_ /= splat(static_cast<double>(places_.size()));
    Eigen::Matrix3d moments = Eigen::Matrix3d::Zero();
    for (Vec& x : places_) {
      x -= mean_;
      for (int a = 0; a < 3; ++a)
        if (cutter.spans(a)) x[a] = 0.0;
      const Eigen::Vector3d p(x[0], x[1], x[2]);
      moments += p * p.transpose();
    }
    for (int a = 0; a < 3; ++a)
      if (cutter.spans(a)) moments(a, a) = 1.0;
    inverse_moments_ = moments.inverse();
  }

  Eigen::Matrix3d gradient(const GrainMotion& motion) const {
    Eigen::Matrix3d products = Eigen::Matrix3d::Zero();
    for (std::size_t k = 0; k < grains_.size(); ++k) {
      const Vec w = motion[2 * grains_[k]], x = places_[k];
      products += Eigen::Vector3d(w[0], w[1], w[2]) * Eigen::Vector3d(x[0], x[1], x[2]).transpose();
    }
    return products * inverse_moments_;
  }

 private:
  std::vector<std::size_t> grains_;
  VecField places_;
  Vec mean_{};
  Eigen::Matrix3d inverse_moments_;
};

struct Share {
  std::size_t bond;
  double share;
};

std::vector<Share> shares_of_bonds(const BondNetwork& network, const Cutter& cutter) {
  std::vector<Share> shares;
  for (std::size_t b = 0; b < network.bonds.size(); ++b) {
    const Bond& bond = network.bonds[b];
    const double share = cutter.share_of_branch(network.centres[bond.i], bond.branch());
    if (share > 0.0) shares.push_back({b, share});
  }
  if (shares.empty())
    throw engine::RequestError("window", "no bond lies in the window", "bond the grains, or move the window");
  return shares;
}

Eigen::Matrix3d mean_stress(const Equilibrium& equilibrium, const std::vector<Share>& shares, int load_case,
                            const GrainMotion& motion, double volume) {
  Eigen::Matrix3d stress = Eigen::Matrix3d::Zero();
  const Eigen::Matrix3d strain = unit_strain(load_case);
  for (const Share& s : shares) {
    const Vec force = equilibrium.bond_force(s.bond, strain, motion);
    const Vec branch = splat(s.share) * equilibrium.network().bonds[s.bond].branch();
    stress +=
        Eigen::Vector3d(force[0], force[1], force[2]) * Eigen::Vector3d(branch[0], branch[1], branch[2]).transpose();
  }
  return stress / volume;
}

void measure_density(const BondNetwork& network, const Cutter& cutter, Homogenised& result) {
  double volume = 0.0, mass = 0.0;
  for (std::size_t g = 0; g < network.size(); ++g) {
    const double inside = cutter.volume_of_sphere(network.centres[g], network.radii[g]);
    volume += inside;
    mass += inside * (network.density.empty() ? 1.0 : network.density[g]);
  }
  result.solid_fraction = volume / cutter.window().volume();
  result.density = mass / cutter.window().volume();
}

}  // namespace

Eigen::Matrix3d unit_strain(int load_case) {
  Eigen::Matrix3d strain = Eigen::Matrix3d::Zero();
  const double value = load_case < 3 ? 1.0 : 0.5;
  strain(voigt_row[load_case], voigt_column[load_case]) = value;
  strain(voigt_column[load_case], voigt_row[load_case]) = value;
  return strain;
}

std::vector<std::uint8_t> held_grains(const BondNetwork& network, const Domain& domain, double held_layer) {
  std::vector<std::uint8_t> held(network.size(), 0);
  const double layer = held_layer * 2.0 * network.mean_radius();
  for (int a = 0; a < 3; ++a) {
    if (domain.periodic[a] || network.size() == 0) continue;
    double lo = INFINITY, hi = -INFINITY;
    for (std::size_t g = 0; g < network.size(); ++g) {
      lo = std::min(lo, network.centres[g][a] - network.radii[g]);
      hi = std::max(hi, network.centres[g][a] + network.radii[g]);
    }
    for (std::size_t g = 0; g < network.size(); ++g)
      if (network.centres[g][a] < lo + layer || network.centres[g][a] > hi - layer) held[g] = all_fixed;
  }
  return held;
}

void solve_load_cases(const Equilibrium& equilibrium, const HomogeniseOptions& options, LoadCases& cases) {
#pragma omp parallel for schedule(dynamic, 1) num_threads(std::clamp(options.threads, 1, 6))
  for (int c = 0; c < 6; ++c) cases.outcome[c] = equilibrium.solve(unit_strain(c), options.limits, cases.motion[c]);
}

Homogenised measure(const Equilibrium& equilibrium, const LoadCases& cases, const Domain& domain,
                    const Window& window) {
  const BondNetwork& network = equilibrium.network();
  const Cutter cutter(window, domain);
  const GradientFit fit(network, cutter);
  const std::vector<Share> shares = shares_of_bonds(network, cutter);
  Homogenised result;
  Stiffness stress, strain;
  for (int c = 0; c < 6; ++c) {
    stress.col(c) = to_voigt(mean_stress(equilibrium, shares, c, cases.motion[c], window.volume()), 1.0);
    strain.col(c) = to_voigt(unit_strain(c) + fit.gradient(cases.motion[c]), 2.0);
    result.residual = std::max(result.residual, cases.outcome[c].residual);
    result.iterations += cases.outcome[c].iterations;
    result.converged = result.converged && cases.outcome[c].converged;
  }
  const Stiffness measured = stress * strain.inverse();
  result.stiffness = 0.5 * (measured + measured.transpose());
  const double size = measured.norm();
  result.asymmetry = size > 0.0 ? 0.5 * (measured - measured.transpose()).norm() / size : 0.0;
  result.isotropic = isotropic_part(result.stiffness);
  measure_density(network, cutter, result);
  return result;
}

Homogenised homogenise(const BondNetwork& network, const Domain& domain, const Window& window,
                       const HomogeniseOptions& options) {
  const Equilibrium equilibrium(network, held_grains(network, domain, options.held_layer));
  LoadCases cases;
  solve_load_cases(equilibrium, options, cases);
  return measure(equilibrium, cases, domain, window);
}

std::array<Isotropic, 8> measure_octants(const Equilibrium& equilibrium, const LoadCases& cases, const Domain& domain,
                                         const Window& window) {
  std::array<Isotropic, 8> parts;
  const Vec half = splat(0.5) * (window.hi - window.lo);
  for (int k = 0; k < 8; ++k) {
    Window part = window;
    for (int a = 0; a < 3; ++a) ((k >> a & 1) != 0 ? part.lo : part.hi)[a] = window.lo[a] + half[a];
    parts[k] = measure(equilibrium, cases, domain, part).isotropic;
  }
  return parts;
}

}  // namespace gabion::dem
