#include <catch2/catch.hpp>

#include "dem_server/packing/equilibrium.hpp"
#include "dem_server/packing/homogenise.hpp"
#include "dem_server/packing/packing.hpp"

using namespace gabion::dem;

namespace {

struct Sample {
  BondNetwork network;
  Domain box;
};

Sample random_sample(bool periodic) {
  PackingRequest request;
  request.box = {vec(0, 0, 0), vec(1, 1, 1), {periodic, periodic, periodic}};
  request.radius = {0.05, 0.1};
  request.seed = 5;
  const Packing packing = make_packing(request);
  return {make_bond_network(packing.position, packing.radius, request.box, packing.gap, {{4e9}, {1e9}}), request.box};
}

}  // namespace

TEST_CASE("stiffness of a contact is that of the two grains in series") {
  const VecField centres{vec(0, 0, 0), vec(0, 3.1, 0)};
  const std::vector<double> radii{1.0, 2.0};
  const BondNetwork network = make_bond_network(centres, radii, {}, 0.05, {{3.0, 6.0}, {1.0, 5.0}});
  REQUIRE(network.bonds.size() == 1);
  const Bond& bond = network.bonds[0];
  CHECK(bond.k_n == Approx(3.0 * 12.0 / 15.0));
  CHECK(bond.k_s == Approx(1.0 * 10.0 / 11.0));
  CHECK(bond.normal[1] == 1.0);
  CHECK(bond.a_i == Approx(1.05));
  CHECK(bond.a_j == Approx(2.05));
  CHECK(bond.distance() == Approx(3.1));
  CHECK(make_bond_network(centres, radii, {}, 0.03, {{1.0}, {1.0}}).bonds.empty());
}

TEST_CASE("a rigid motion strains no bond") {
  const Sample sample = random_sample(false);
  const Equilibrium equilibrium(sample.network, {});
  const Vec shift = vec(0.3, -0.2, 0.7), turn = vec(0.5, 1.1, -0.4);
  GrainMotion motion;
  for (const Vec x : sample.network.centres) {
    motion.push_back(shift + cross(turn, x));
    motion.push_back(splat(sample.network.mean_radius()) * turn);
  }
  double largest = 0.0;
  for (std::size_t b = 0; b < sample.network.bonds.size(); ++b)
    largest = std::max(largest,
                       norm(equilibrium.bond_force(b, Eigen::Matrix3d::Zero(), motion)) / sample.network.bonds[b].k_n);
  CHECK(largest < 1e-14);
}

TEST_CASE("a held chain shares the stretch as springs in series do") {
  // Three spheres in a row, the ends held at the affine stretch; k1 of the first bond, k2 of the second
  const VecField centres{vec(0, 0, 0), vec(2, 0, 0), vec(4, 0, 0)};
  const std::vector<double> radii{1.0, 1.0, 1.0};
  BondNetwork network = make_bond_network(centres, radii, {}, 1e-6, {{1.0}, {0.4}});
  network.bonds[0].k_n = 3.0;
  network.bonds[1].k_n = 1.0;
  const Equilibrium equilibrium(network, {all_fixed, 0, all_fixed});
  GrainMotion motion;
  CHECK(equilibrium.solve(unit_strain(0), {}, motion).converged);
  // force 4 k1 k2/(k1 + k2) over the unit strain; middle grain at 4 k2/(k1 + k2) = 1, affine place is 2
  CHECK(equilibrium.bond_force(0, unit_strain(0), motion)[0] == Approx(3.0).epsilon(1e-12));
  CHECK(motion[2][0] == Approx(-1.0).epsilon(1e-12));
}

TEST_CASE("forces and torques balance on every grain that is not held") {
  for (const bool periodic : {true, false}) {
    const Sample sample = random_sample(periodic);
    const std::vector<std::uint8_t> held = held_grains(sample.network, sample.box, 1.0);
    const Equilibrium equilibrium(sample.network, held);
    const Eigen::Matrix3d strain = unit_strain(3);
    GrainMotion motion;
    const SolveOutcome outcome = equilibrium.solve(strain, {}, motion);
    REQUIRE(outcome.converged);
    VecField force(sample.network.size(), Vec{}), torque(sample.network.size(), Vec{});
    double scale = 0.0;
    for (std::size_t b = 0; b < sample.network.bonds.size(); ++b) {
      const Bond& bond = sample.network.bonds[b];
      const Vec f = equilibrium.bond_force(b, strain, motion);
      force[bond.i] += f;
      force[bond.j] -= f;
      torque[bond.i] += splat(bond.a_i) * cross(bond.normal, f);
      torque[bond.j] += splat(bond.a_j) * cross(bond.normal, f);
      scale = std::max(scale, norm(f));
    }
    double unbalanced = 0.0;
    for (std::size_t g = 0; g < force.size(); ++g)
      if (!held[g]) unbalanced = std::max({unbalanced, norm(force[g]), norm(torque[g]) / sample.network.mean_radius()});
    CHECK(unbalanced < 1e-8 * scale);
  }
}

TEST_CASE("a warm start from the answer needs no iteration, grains without bonds do no harm") {
  Sample sample = random_sample(true);
  sample.network.centres.push_back(vec(0.5, 0.5, 0.5));
  sample.network.radii.push_back(0.01);
  const Equilibrium equilibrium(sample.network, {});
  GrainMotion motion;
  CHECK(equilibrium.solve(unit_strain(1), {}, motion).converged);
  CHECK(equilibrium.solve(unit_strain(1), {2e-10, 20000}, motion).iterations <= 1);
}
