#include <Eigen/Dense>
#include <catch2/catch.hpp>

#include "continuum_server/stable_step.hpp"
#include "solid_fixture.hpp"
#include "tests/figure.hpp"

using namespace gabion::continuum;
namespace engine = gabion::engine;
using engine::vec;

namespace {

/// 2/omega_max from the dense eigenvalue problem.
double dense_limit(const Solid& solid) {
  const auto& motion = solid.engine.motion;
  const auto size = static_cast<Eigen::Index>(3 * motion.size());
  Eigen::MatrixXd k = Eigen::MatrixXd::Zero(size, size);
  for (std::size_t e = 0; e < solid.engine.mesh().elements.size(); ++e) {
    const ElementStiffness stiffness = solid.engine.element_stiffness(e);
    const auto& nodes = solid.engine.mesh().elements[e];
    for (int r = 0; r < 24; ++r)
      for (int s = 0; s < 24; ++s) k(3 * nodes[r / 3] + r % 3, 3 * nodes[s / 3] + s % 3) += stiffness[24 * r + s];
  }
  Eigen::VectorXd scale(size);
  for (Eigen::Index d = 0; d < size; ++d) scale[d] = motion.freedom[d / 3][d % 3] / std::sqrt(motion.mass[d / 3]);
  k = scale.asDiagonal() * k * scale.asDiagonal();
  const double largest =
      Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(k, Eigen::EigenvaluesOnly).eigenvalues()[size - 1];
  return 2.0 / std::sqrt(largest);
}

void check_limit(Solid& solid) {
  solid.engine.prepare();
  const double limit = dense_limit(solid), found = solid.engine.stable_step();
  CHECK(found <= limit * (1 + 1e-9));
  CHECK(found >= 0.995 * limit);
}

}  // namespace

TEST_CASE("the stable step is the dense eigenvalue's, from below, within half a per cent") {
  for (const double poisson : {0.0, 0.3, 0.45, 0.49})
    for (const int edge : {1, 2, 5}) {
      CAPTURE(poisson, edge);
      Solid solid(box_mesh({edge, edge, edge}, vec(1, 1, 1)), isotropic(1e6, poisson, 1000.0));
      check_limit(solid);
    }
}

TEST_CASE("the stable step knows of constraints, weights and odd shapes") {
  Solid held(box_mesh({3, 3, 3}, vec(1, 2, 3)), isotropic(1e6, 0.3, 1000.0));
  held.hold(
      "base", [](Vec x) { return x[2] == 0.0; }, 7);
  check_limit(held);

  Mesh odd = box_mesh({4, 3, 3}, vec(4, 3, 3));
  distort(odd, 0.25);
  Solid distorted(odd, isotropic(1e6, 0.3, 1000.0));
  check_limit(distorted);

  Solid weighted(box_mesh({6, 3, 3}, vec(6, 3, 3)), isotropic(1e6, 0.3, 1000.0));
  weighted.engine.weights = {vec(-INFINITY, -INFINITY, -INFINITY), vec(4, INFINITY, INFINITY), 3.0, 0.01};
  check_limit(weighted);
}

TEST_CASE("one stiff element in a large mesh is found") {
  const SolidMaterial soft = isotropic(1e6, 0.3, 1000.0), stiff = isotropic(20e6, 0.3, 1000.0);
  const auto inclusion = [&](int edge) {
    Mesh mesh = box_mesh({edge, edge, edge}, vec(edge, edge, edge));
    mesh.material[(edge / 2) * (edge * edge + edge + 1)] = 1;
    return mesh;
  };
  // The mode is local: the size of what lies around does not show, so a small dense problem is the reference.
  Solid large(inclusion(20), soft), small(inclusion(5), soft);
  for (Solid* solid : {&large, &small}) {
    solid->engine.set_materials({soft, stiff});
    solid->engine.prepare();
  }
  const double limit = dense_limit(small);
  CHECK(large.engine.stable_step() <= limit * (1 + 1e-4));
  CHECK(large.engine.stable_step() >= 0.995 * limit);
}

TEST_CASE("a free cube at nu 0.45 stays bounded at 0.99 of the step and does not above it") {
  Solid solid(box_mesh({2, 2, 2}, vec(1, 1, 1)), isotropic(1e6, 0.45, 1000.0));
  solid.engine.prepare();
  const double limit = solid.engine.stable_step();
  solid.set_noise(solid.engine.motion.velocity, 1e-3);
  solid.run(1, 0.99 * limit);
  const double energy = solid.engine.ledger().balance();
  double drift = 0.0;
  for (int part = 0; part < 10; ++part) {
    solid.run(10000, 0.99 * limit);
    drift = std::max(drift, std::fabs(solid.engine.ledger().balance() / energy - 1.0));
    // near the limit the discrete energy of the highest mode is a small difference of large terms
    CHECK(solid.engine.ledger().balance() == Approx(energy).epsilon(1e-10));
    CHECK(solid.engine.motion.largest_speed() < 0.1);
  }
  gabion::figure("free_cube_drift", drift);
  CHECK_THROWS_AS(solid.run(100000, 1.01 * limit), engine::PhysicsError);
}

TEST_CASE("dashpots cost no step") {
  Solid solid(box_mesh({2, 2, 6}, vec(2, 2, 6)), isotropic(1e6, 0.3, 1000.0));
  const auto base = solid.nodes([](Vec x) { return x[2] == 0.0; });
  solid.engine.boundary.add(engine::Dashpot{"base", base, VecField(base.size(), vec(1e4, 1e4, 3e4))},
                            solid.engine.motion.size());
  solid.engine.prepare();
  const double limit = solid.engine.stable_step();
  solid.set_noise(solid.engine.motion.velocity, 1e-3);
  solid.run(20000, 0.999 * limit);
  CHECK(solid.engine.motion.largest_speed() < 1e-3);
}
