// Hourglassing: patterns of corners that move to and fro and cost too little energy. The brick integrates its whole
// energy and has no hourglass control, so that there is no artificial energy; what is looked at is whether a load on
// one node, the worst case, leaves any of the pattern that alternates in all three directions.

#include <Eigen/Dense>
#include <algorithm>
#include <catch2/catch.hpp>

#include "solid_fixture.hpp"
#include "tests/figure.hpp"

using namespace gabion;
using namespace gabion::continuum;
using engine::vec;

namespace {

/// Sign of xi eta zeta at a corner.
double alternating(int corner) {
  constexpr int bits[8] = {0, 1, 3, 2, 4, 5, 7, 6};  // x, y, z of the mesh's corner order
  const int b = bits[corner];
  return ((b & 1) + (b >> 1 & 1) + (b >> 2)) % 2 ? 1.0 : -1.0;
}

/// Energy of the alternating pattern in one element of these corner displacements, J.
double alternating_energy(const ElementStiffness& k, const std::array<Vec, 8>& u) {
  Eigen::Matrix3d stiffness = Eigen::Matrix3d::Zero();
  Eigen::Vector3d amplitude = Eigen::Vector3d::Zero();
  for (int a = 0; a < 8; ++a) {
    for (int i = 0; i < 3; ++i) amplitude[i] += alternating(a) * u[a][i] / 8;
    for (int b = 0; b < 8; ++b)
      for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j) stiffness(i, j) += alternating(a) * alternating(b) * k[24 * (3 * a + i) + 3 * b + j];
  }
  return 0.5 * amplitude.dot(stiffness * amplitude);
}

/// A cube on a fixed base under a load on the middle node of its top, at rest.
struct Loaded {
  Solid solid;
  int edge, top;
  double internal;  ///< J

  Loaded(int edge_, double poisson)
      : solid(box_mesh({edge_, edge_, edge_}, vec(1, 1, 1)), isotropic(1e6, poisson, 1000.0)), edge(edge_) {
    solid.engine.prepare();
    std::map<int, double> held;
    for (const std::int32_t n : solid.nodes([](Vec x) { return x[2] == 0.0; }))
      for (int axis = 0; axis < 3; ++axis) held[3 * n + axis] = 0.0;
    top = node(vec(0.5, 0.5, 1));
    VecField load(solid.engine.motion.size(), Vec{});
    load[top] = vec(0, 0, -1.0);
    solid.solve_static(held, load);
    internal = -0.5 * solid.engine.motion.displacement[top][2];
  }
  int node(Vec x) const {
    for (std::size_t n = 0; n < solid.engine.motion.size(); ++n)
      if (engine::norm(solid.engine.motion.position[n] - x) < 1e-9) return static_cast<int>(n);
    FAIL("no node there");
    return -1;
  }
};

}  // namespace

TEST_CASE("a load on one node leaves no hourglass pattern") {
  // The four elements under the load have one corner pushed in, in any mesh. What counts is the pattern in all others, and
  // that it does not run on: what is left one element further away.
  double share = 0.0, far_away = 0.0, nearly_incompressible = 0.0;
  for (const double poisson : {0.0, 0.3, 0.36, 0.49}) {
    CAPTURE(poisson);
    const Loaded block(8, poisson);
    double beside = 0.0, further = 0.0;
    const auto& mesh = block.solid.engine.mesh();
    for (std::size_t e = 0; e < mesh.elements.size(); ++e) {
      const auto& nodes = mesh.elements[e];
      std::array<Vec, 8> u;
      double nearest = 10.0;
      for (int a = 0; a < 8; ++a) {
        u[a] = block.solid.engine.motion.displacement[nodes[a]];
        const Vec from = mesh.nodes[nodes[a]] - mesh.nodes[block.top];
        nearest = std::min(nearest, std::max({std::fabs(from[0]), std::fabs(from[1]), std::fabs(from[2])}));
      }
      const double energy = alternating_energy(block.solid.engine.element_stiffness(e), u) / block.internal;
      if (nearest > 0.5 / block.edge) beside += energy;
      if (nearest > 1.5 / block.edge) further += energy;
    }
    (poisson < 0.4 ? share : nearly_incompressible) = std::max(poisson < 0.4 ? share : 0.0, beside);
    if (poisson < 0.4) far_away = std::max(far_away, further);
    CHECK(further < 0.2 * beside);
  }
  CHECK(share < 0.01);
  CHECK(far_away < 1e-3);
  figure("hourglass_share_point_load", share);
  figure("hourglass_share_further_away", far_away);
  figure("hourglass_share_nu_049", nearly_incompressible);
}
