#pragma once
// Elastic stiffness of a bonded packing; the messages HOMOGENISE and HOMOGENISED.
//
// Six macroscopic strains are imposed: in periodic directions as a jump over the period with periodic
// fluctuations, at other faces of the packing by giving the grains near the face the affine displacement
// without rotation. Everything else relaxes (equilibrium.hpp). Then, in the window,
//
//   Sigma = 1/V sum over bonds of share * F (x) branch     share: of the branch inside the window
//   strain = symmetric gradient of the affine fit (least squares) to the displacements of the grains
//            inside; along a direction that the window spans over a whole period it is the imposed one
//   C = [Sigma of the six cases] [strain of the six cases]^-1, then its symmetric part

#include <array>
#include <vector>

#include "dem_server/packing/equilibrium.hpp"
#include "dem_server/packing/isotropy.hpp"
#include "dem_server/packing/window.hpp"

namespace gabion::dem {

struct HomogeniseOptions {
  SolveLimits limits;
  double held_layer =
      1.0;          ///< grains with centres nearer than this to a flat face of the packing are held, mean diameters
  int threads = 1;  ///< 1 to 6 load cases at a time; the answer does not depend on it
};

struct Homogenised {
  Stiffness stiffness = Stiffness::Zero();  ///< Pa
  double asymmetry = 0.0;                   ///< norm of the antisymmetric part of C as measured over the norm of C
  double density = 0.0;         ///< mass of grains over volume in the window, kg/m3; see Cutter::volume_of_sphere
  double solid_fraction = 0.0;  ///< in the window
  double residual = 0.0;        ///< largest relative residual of the six equilibria
  int iterations = 0;           ///< of all six
  bool converged = true;
  Isotropic isotropic;
};

/// Answers to the six unit strains (Voigt order; shear as engineering strain), ready to be measured in
/// any window. Keep it to warm-start a solve of the same packing with other stiffnesses.
struct LoadCases {
  std::array<GrainMotion, 6> motion;
  std::array<SolveOutcome, 6> outcome;
};

/// Unit strain of a load case, as a tensor.
Eigen::Matrix3d unit_strain(int load_case);

/// all_fixed for grains near the flat faces of the packing (its own extent, where the domain is not periodic).
std::vector<std::uint8_t> held_grains(const BondNetwork& network, const Domain& domain, double held_layer);

/// cases holds the starts (may be empty) and receives the answers.
void solve_load_cases(const Equilibrium& equilibrium, const HomogeniseOptions& options, LoadCases& cases);

/// Measures solved load cases in a window. Throws engine::RequestError when the window holds too few
/// grains for a strain (fewer than 8) or no bond.
Homogenised measure(const Equilibrium& equilibrium, const LoadCases& cases, const Domain& domain, const Window& window);

/// All of the above. A wise window stays two mean diameters inside the held layers.
Homogenised homogenise(const BondNetwork& network, const Domain& domain, const Window& window,
                       const HomogeniseOptions& options = {});

/// Isotropic moduli in the eight halves by halves by halves of the window.
std::array<Isotropic, 8> measure_octants(const Equilibrium& equilibrium, const LoadCases& cases, const Domain& domain,
                                         const Window& window);

}  // namespace gabion::dem
