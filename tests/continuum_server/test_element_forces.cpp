#include <Eigen/Dense>
#include <catch2/catch.hpp>

#include "continuum_server/element_forces.hpp"
#include "solid_fixture.hpp"

using namespace gabion::continuum;
namespace engine = gabion::engine;
using engine::vec;

namespace {

using Matrix24 = Eigen::Matrix<double, 24, 24, Eigen::RowMajor>;

Matrix24 matrix(const ElementStiffness& k) {
  return Eigen::Map<const Matrix24>(k.data());
}

/// Bricks of two materials, and distorted elements in the middle; shares that differ.
struct Mixed {
  Mesh mesh = box_mesh({7, 5, 4}, vec(7, 4, 2));
  ElementForces forces;
  VecField u, force;

  Mixed() {
    mesh.nodes[8 * 6 * 2 + 8 * 3 + 3] += vec(0.1, -0.07, 0.05);
    std::vector<double> share;
    for (std::size_t e = 0; e < mesh.elements.size(); ++e) {
      mesh.material[e] = e % 3 == 0;
      share.push_back(1.0 / (1.0 + static_cast<double>(e % 5)));
    }
    forces.build(mesh, {isotropic(1.0, 0.3, 1.0), triclinic()}, share, Vec{});
    for (const Vec x : mesh.nodes)
      u.push_back(vec(std::sin(9 * x[0] + x[1]), std::sin(7 * x[1] - x[2]), std::cos(8 * x[2] * x[0])));
    force.resize(u.size());
  }

  void evaluate() {
    forces.start({}, force);
    forces.subtract(Part::interface, u, force);
    forces.subtract(Part::interior, u, force);
  }
};

bool same_bits(const VecField& a, const VecField& b) {
  return std::memcmp(a.data(), b.data(), a.size() * sizeof(Vec)) == 0;
}

}  // namespace

TEST_CASE("the brick's kernel is the dense element's stiffness, and keeps six zero modes") {
  for (const SolidMaterial& material : {isotropic(1.0, 0.3, 1.0), isotropic(1.0, 0.4999, 1.0), triclinic()})
    for (const Vec edges : {vec(1, 1, 1), vec(0.5, 1, 3)}) {
      const Mesh mesh = box_mesh({1, 1, 1}, edges);
      ElementForces forces;
      forces.build(mesh, {material}, {0.75}, Vec{});
      REQUIRE(forces.bricks() == 1);
      const Matrix24 kernel = matrix(forces.stiffness(0));
      const Matrix24 dense = 0.75 * matrix(condensed_stiffness(corners_of(mesh, 0, Vec{}), material));
      CHECK((kernel - dense).norm() <= 1e-13 * dense.norm());
      const auto values = Eigen::SelfAdjointEigenSolver<Matrix24>(kernel).eigenvalues().eval();
      CHECK(std::fabs(values[5]) < 1e-13 * values[23]);
      CHECK(values[6] > 1e-3 * values[6 + 1]);
      CHECK(values[6] > 1e-9 * values[23]);
    }
}

TEST_CASE("the distorted kernel is the dense element's stiffness") {
  Mesh mesh = box_mesh({1, 1, 1}, vec(1, 1, 1));
  distort(mesh, 0.2);
  ElementForces forces;
  forces.build(mesh, {triclinic()}, {0.5}, Vec{});
  REQUIRE(forces.distorted() == 1);
  const Matrix24 dense = 0.5 * matrix(condensed_stiffness(corners_of(mesh, 0, Vec{}), triclinic()));
  CHECK((matrix(forces.stiffness(0)) - dense).norm() <= 1e-13 * dense.norm());
}

TEST_CASE("forces have the same bits for any number of threads") {
  Mixed mixed;
  CHECK(mixed.forces.distorted() == 8);
  for (const std::size_t reach : {0u, 40u}) {
    mixed.forces.arrange(reach, 1);
    mixed.evaluate();
    const VecField serial = mixed.force;
    for (const int threads : {2, 3, 7}) {
      mixed.forces.arrange(reach, threads);
      mixed.evaluate();
      CHECK(same_bits(serial, mixed.force));
    }
  }
}

TEST_CASE("the interface part completes the interface's nodes, whatever the arrangement") {
  Mixed mixed;
  mixed.evaluate();
  const VecField plain = mixed.force;
  const std::size_t reach = 50;
  mixed.forces.arrange(reach, 2);
  mixed.forces.start({}, mixed.force);
  mixed.forces.subtract(Part::interface, mixed.u, mixed.force);
  double error = 0.0;
  for (std::size_t n = 0; n < reach; ++n) error = std::max(error, engine::norm(mixed.force[n] - plain[n]));
  CHECK(error < 1e-13);
  mixed.forces.subtract(Part::interior, mixed.u, mixed.force);
  for (std::size_t n = reach; n < plain.size(); ++n) error = std::max(error, engine::norm(mixed.force[n] - plain[n]));
  CHECK(error < 1e-13);
}

TEST_CASE("elastic energy is half the work of the forces") {
  Mixed mixed;
  mixed.evaluate();
  double work = 0.0;
  for (std::size_t n = 0; n < mixed.u.size(); ++n) work -= 0.5 * engine::dot(mixed.u[n], mixed.force[n]);
  CHECK(mixed.forces.energy(mixed.u) == Approx(work).epsilon(1e-13));
}
