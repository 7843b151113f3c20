// Physics: statics against closed forms.

#include <catch2/catch.hpp>
#include <numbers>

#include "solid_fixture.hpp"
#include "tests/figure.hpp"

using namespace gabion::continuum;
namespace engine = gabion::engine;
using engine::dot;
using engine::norm;
using engine::vec;

namespace {

constexpr double pi = std::numbers::pi;

/// MacNeal & Harder (1985): a unit cube of seven irregular hexahedra. Their inner nodes turn one corner inside out,
/// which the engine refuses, so they are drawn back towards a regular cube by a quarter.
Mesh patch_of_seven() {
  Mesh mesh;
  for (int n = 0; n < 8; ++n) mesh.nodes.push_back(vec(n & 1, n >> 1 & 1, n >> 2));
  for (const Vec inner : {vec(.249, .342, .192), vec(.826, .288, .288), vec(.273, .750, .230), vec(.850, .649, .263),
                          vec(.320, .186, .643), vec(.677, .305, .683), vec(.165, .745, .702), vec(.788, .693, .644)})
    mesh.nodes.push_back(inner);
  for (int bits = 0; bits < 8; ++bits) {
    const Vec regular = vec(0.25, 0.25, 0.25) + engine::splat(0.5) * mesh.nodes[bits];
    mesh.nodes[bits + 8] += engine::splat(0.25) * (regular - mesh.nodes[bits + 8]);
  }
  // corners by bits: outer cube 0 to 7, inner one 8 to 15; the inner one, and one element a face
  const auto element = [&](std::array<int, 8> by_bits) {
    auto& nodes = mesh.elements.emplace_back();
    constexpr int order[8] = {0, 1, 3, 2, 4, 5, 7, 6};
    for (int c = 0; c < 8; ++c) nodes[c] = by_bits[order[c]];
    mesh.material.push_back(0);
  };
  element({8, 9, 10, 11, 12, 13, 14, 15});
  for (int axis = 0; axis < 3; ++axis)
    for (const int side : {0, 1}) {
      std::array<int, 8> corners;
      for (int bits = 0; bits < 8; ++bits) {
        const bool outer = (bits >> axis & 1) == side;
        const int on_face = (bits & ~(1 << axis)) | side << axis;
        corners[bits] = outer ? on_face : on_face + 8;
      }
      element(corners);
    }
  return mesh;
}

/// References: u = 1e-3 (2x + y + z)/2, and so on round.
Vec patch_displacement(Vec x) {
  return engine::splat(0.5e-3) * vec(2 * x[0] + x[1] + x[2], x[0] + 2 * x[1] + x[2], x[0] + x[1] + 2 * x[2]);
}

/// Quarter of a thick cylinder in plane strain, pressure 1 inside; radii as MacNeal & Harder's, each layer halved.
struct Cylinder : Solid {
  static constexpr int around = 9;

  static std::vector<double> radii() {
    std::vector<double> all;
    const double given[] = {3, 3.5, 4.2, 5.2, 6.75, 9};
    for (int k = 0; k < 5; ++k) all.insert(all.end(), {given[k], 0.5 * (given[k] + given[k + 1])});
    all.push_back(9);
    return all;
  }

  static Mesh quarter() {
    const auto layers = static_cast<int>(radii().size()) - 1;
    Mesh mesh = box_mesh({layers, around, 1}, vec(layers, around, 1));
    for (Vec& x : mesh.nodes) {
      const double r = radii()[static_cast<std::size_t>(std::lround(x[0]))], angle = 0.5 * pi * x[1] / around;
      x = vec(r * std::cos(angle), r * std::sin(angle), x[2]);
    }
    return mesh;
  }

  explicit Cylinder(double poisson) : Solid(quarter(), isotropic(1000.0, poisson, 1.0)) { engine.prepare(); }

  /// Mean radial displacement at the inner face.
  double solve() {
    std::map<int, double> given;
    VecField load(engine.motion.size(), Vec{});
    const auto at = [&](std::size_t n) { return engine.motion.position[n]; };
    for (std::size_t n = 0; n < load.size(); ++n) {
      const int d = 3 * static_cast<int>(n);
      given[d + 2] = 0.0;
      if (std::fabs(at(n)[1]) < 1e-12) given[d + 1] = 0.0;
      if (std::fabs(at(n)[0]) < 1e-12) given[d] = 0.0;
    }
    std::vector<std::int32_t> inner;
    for (const auto& nodes : engine.mesh().elements) {
      if (std::fabs(norm(at(nodes[0]) * vec(1, 1, 0)) - 3.0) > 1e-9) continue;
      // the inner face is 0, 3, 7, 4: pressure on the chord, a quarter of it to each node
      const Vec chord = at(nodes[3]) - at(nodes[0]);
      for (const int corner : {0, 3, 4, 7}) {
        load[nodes[corner]] += engine::splat(0.25) * vec(chord[1], -chord[0], 0);
        inner.push_back(nodes[corner]);
      }
    }
    solve_static(given, load);
    double total = 0.0;
    for (const std::int32_t n : inner) total += dot(engine.motion.displacement[n], at(n)) / 3.0;
    return total / static_cast<double>(inner.size());
  }
};

}  // namespace

TEST_CASE("patch test: seven irregular hexahedra carry a uniform strain exactly") {
  Solid solid(patch_of_seven(), isotropic(1e6, 0.25, 1.0));
  solid.engine.prepare();
  CHECK(solid.engine.counters()[3].value == 7);
  std::map<int, double> given;
  for (int n = 0; n < 8; ++n)
    for (int axis = 0; axis < 3; ++axis)
      given[3 * n + axis] = patch_displacement(solid.engine.motion.position[n])[axis];
  solid.solve_static(given, VecField(16, Vec{}));
  for (int n = 8; n < 16; ++n)
    CHECK(norm(solid.engine.motion.displacement[n] - patch_displacement(solid.engine.motion.position[n])) < 1e-15);
  const auto stress = solid.values("stress");
  for (std::size_t k = 0; k < stress.size(); ++k) CHECK(stress[k] == Approx(k % 6 < 3 ? 2000 : 400).epsilon(1e-12));
}

TEST_CASE("a uniform strain gives C times strain, and no force inside, with a full 6 x 6 stiffness") {
  Mesh mesh = box_mesh({3, 3, 3}, vec(1, 1, 1));
  SECTION("bricks") {}
  SECTION("distorted") {
    distort(mesh, 0.08);
  }
  const SolidMaterial rock = triclinic();
  Solid solid(mesh, rock);
  solid.engine.prepare();
  const double strain[6] = {1e-3, -2e-3, 3e-3, 5e-3, 4e-3, -6e-3};
  solid.set(solid.engine.motion.displacement, [&](Vec x) {
    return vec(strain[0] * x[0] + 0.5 * strain[5] * x[1] + 0.5 * strain[4] * x[2],
               0.5 * strain[5] * x[0] + strain[1] * x[1] + 0.5 * strain[3] * x[2],
               0.5 * strain[4] * x[0] + 0.5 * strain[3] * x[1] + strain[2] * x[2]);
  });
  const auto stress = solid.values("stress");
  for (std::size_t e = 0; e < 27; ++e)
    for (int r = 0; r < 6; ++r) {
      double expected = 0.0;
      for (int s = 0; s < 6; ++s) expected += rock.stiffness[6 * r + s] * strain[s];
      CHECK(stress[6 * e + r] == Approx(expected).epsilon(1e-12));
    }
  solid.run(1, 1e-9);
  // nodes 21, 22, 25, 26, 37, 38, 41, 42 are inside
  for (const int n : {21, 22, 25, 26, 37, 38, 41, 42}) CHECK(norm(solid.engine.motion.force[n]) < 1e-16);
  CHECK(norm(solid.engine.motion.force[0]) > 1e-5);
}

TEST_CASE("a rigid translation and an infinitesimal rotation give no stress and no force") {
  Mesh mesh = box_mesh({4, 3, 3}, vec(4, 3, 3));
  SECTION("bricks") {}
  SECTION("distorted") {
    distort(mesh, 0.2);
  }
  Solid solid(mesh, isotropic(1.0, 0.3, 1.0));
  solid.engine.prepare();
  solid.set(solid.engine.motion.displacement,
            [](Vec x) { return vec(0.3, -0.2, 0.1) + engine::cross(vec(1e-2, 2e-2, -3e-2), x); });
  for (const double s : solid.values("stress")) CHECK(std::fabs(s) < 1e-12 * 1e-2);
  solid.run(1, 1e-9);
  for (const Vec f : solid.engine.motion.force) CHECK(norm(f) < 1e-12 * 1e-2);
}

TEST_CASE("no volumetric locking: thick cylinder in plane strain") {
  const auto [poisson, expected] =
      GENERATE(table<double, double>({{.49, 5.0399e-3}, {.499, 5.0602e-3}, {.4999, 5.0623e-3}}));
  const double found = Cylinder(poisson).solve();
  CAPTURE(poisson, found / expected);
  CHECK(found == Approx(expected).epsilon(0.01));
  gabion::figure("cylinder_error", std::fabs(found / expected - 1.0));
}

TEST_CASE("no shear locking: cantilever under its own weight") {
  Solid solid(box_mesh({20, 2, 2}, vec(0.2, 0.02, 0.02)), isotropic(1e8, 0.0, 2500.0), false);
  solid.engine.options.gravity = vec(0, 0, -9.8);
  solid.hold(
      "wall", [](Vec x) { return x[0] == 0.0; }, 7);
  solid.engine.prepare();
  solid.run(15000, 0.69 * solid.engine.stable_step(), 0.7);
  CHECK(solid.engine.unbalanced() < 1e-6);
  double tip = 0.0;
  const auto end = solid.nodes([](Vec x) { return x[0] > 0.1999; });
  for (const std::int32_t n : end) tip -= solid.engine.motion.displacement[n][2] / static_cast<double>(end.size());
  CAPTURE(tip / 1.4818e-3);
  CHECK(tip == Approx(1.4818e-3).epsilon(0.01));
  gabion::figure("cantilever_error", std::fabs(tip / 1.4818e-3 - 1.0));
}
