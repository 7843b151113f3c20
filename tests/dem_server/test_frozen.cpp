// Frozen geometry: lattices, waves, energy over many steps.

#include <Eigen/Eigenvalues>
#include <numbers>

#include "dem_server/stable_step.hpp"
#include "fixture.hpp"

using namespace gabion::dem;
using namespace gabion::dem::testing;

namespace {

/// Strain energy density of a bonded periodic packing for an affine motion without rotations, from the
/// forces of the kernel: W = 1/(2V) sum over bonds of f.du, images moved by strain times period.
double affine_energy(const Spheres& s, Vec period, const GrainMaterial& material, const double strain[3][3]) {
  // a lattice under uniform strain has no fluctuations: the energy of one cell with its images,
  // realised on a block so large that every bond of the middle cells stays inside it
  Scene scene;
  scene.grains(s.x, s.r, material);
  scene.engine.make_bonds(1e-6);
  scene.prepare(Geometry::frozen);
  VecField u(s.x.size());
  for (std::size_t i = 0; i < u.size(); ++i)
    for (int a = 0; a < 3; ++a)
      for (int b = 0; b < 3; ++b) u[i][a] += strain[a][b] * s.x[i][b];
  scene.set("displacement", u);
  std::vector<std::uint64_t> shape;
  const auto rows = *scene.engine.field("contact", shape);
  double energy = 0.0;
  const auto inside = [&](Vec x) {
    for (int a = 0; a < 3; ++a)
      if (x[a] < 2.0 - 1e-9 || x[a] >= 2.0 + period[a] - 1e-9) return false;
    return true;
  };
  for (std::size_t c = 0; c < shape[0]; ++c) {
    const auto i = static_cast<std::size_t>(rows[8 * c]), j = static_cast<std::size_t>(rows[8 * c + 1]);
    const Vec f = vec(rows[8 * c + 5], rows[8 * c + 6], rows[8 * c + 7]);
    const double share = 0.5 * (inside(s.x[i]) + inside(s.x[j]));
    energy += share * 0.5 * dot(f, u[j] - u[i]);
  }
  return energy / (period[0] * period[1] * period[2]);
}

double modulus(const Spheres& s, Vec period, const GrainMaterial& m, int a, int b, int c, int d) {
  double one[3][3] = {}, two[3][3] = {}, both[3][3] = {};
  one[a][b] += 0.5, one[b][a] += 0.5;
  two[c][d] += 0.5, two[d][c] += 0.5;
  for (int p = 0; p < 3; ++p)
    for (int q = 0; q < 3; ++q) both[p][q] = one[p][q] + two[p][q];
  return affine_energy(s, period, m, both) - affine_energy(s, period, m, one) - affine_energy(s, period, m, two);
}

}  // namespace

TEST_CASE("moduli of the face-centred lattice") {
  const Spheres s = face_centred(5, 5, 5);
  const GrainMaterial m = elastic_material();
  const double R = s.r[0], kn = 0.5 * m.normal_stiffness * R, ks = 0.5 * m.shear_stiffness * R;
  const Vec cell = vec(1, 1, 1);
  CHECK(modulus(s, cell, m, 0, 0, 0, 0) == Approx((kn + ks) / (std::sqrt(2.0) * R)).epsilon(1e-8));
  CHECK(modulus(s, cell, m, 0, 0, 1, 1) == Approx((kn - ks) / (2 * std::sqrt(2.0) * R)).epsilon(1e-8));
  CHECK(modulus(s, cell, m, 1, 2, 1, 2) == Approx((kn + ks) / (2 * std::sqrt(2.0) * R)).epsilon(1e-8));
}

TEST_CASE("moduli of the simple cubic lattice") {
  Spheres s;
  for (int k = 0; k < 6; ++k)
    for (int j = 0; j < 6; ++j)
      for (int i = 0; i < 6; ++i) {
        s.x.push_back(vec(i, j, k));
        s.r.push_back(0.5);
      }
  const GrainMaterial m = elastic_material();
  const double R = 0.5, kn = 0.5 * m.normal_stiffness * R, ks = 0.5 * m.shear_stiffness * R;
  const Vec cell = vec(1, 1, 1);
  CHECK(modulus(s, cell, m, 0, 0, 0, 0) == Approx(kn / (2 * R)).epsilon(1e-8));
  CHECK(modulus(s, cell, m, 0, 0, 1, 1) == Approx(0.0).margin(1e-8 * kn));
  CHECK(modulus(s, cell, m, 1, 2, 1, 2) == Approx(ks / (4 * R)).epsilon(1e-8));
}

TEST_CASE("a P wave crosses a face-centred column at sqrt(C11/rho)") {
  // one cell wide and deep: every grain meets several images of its neighbours
  for (const int wide : {1, 2}) {
    const int high = 128;
    const Spheres s = face_centred(wide, wide, high);
    const GrainMaterial m = elastic_material();
    Scene scene;
    scene.periodic_box(vec(0, 0, 0), vec(wide, wide, high));
    scene.grains(s.x, s.r, m);
    REQUIRE(scene.engine.make_bonds(1e-6).contacts_per_grain == 12.0);
    scene.prepare(Geometry::frozen);
    const double R = s.r[0], kn = 0.5 * m.normal_stiffness * R, ks = 0.5 * m.shear_stiffness * R;
    const double c11 = (kn + ks) / (std::sqrt(2.0) * R), density = m.density * std::numbers::pi * std::sqrt(2.0) / 6.0;
    const double speed = std::sqrt(c11 / density), k = 2 * std::numbers::pi / high;
    VecField u(s.x.size());
    for (std::size_t i = 0; i < u.size(); ++i) u[i] = vec(0, 0, 1e-6 * std::cos(k * s.x[i][2]));
    scene.set("displacement", u);
    // a standing wave: its first zero comes after a quarter of a period
    const double dt = 0.2 * scene.engine.stable_step();
    double before = u[0][2];
    int steps = 0;
    while (before > 0.0) {
      const double at_start = scene.engine.motion.displacement[0][2];
      scene.step(dt);
      const double now = scene.engine.motion.displacement[0][2];
      ++steps;
      if (now <= 0.0) {
        const double quarter = dt * (steps - 1 + at_start / (at_start - now));
        // at rest at n - 1/2: the wave turned half a step before the first one
        CHECK(quarter + 0.5 * dt == Approx(high / speed / 4.0).epsilon(1e-3));
        break;
      }
      before = now;
      REQUIRE(steps < 100000);
    }
  }
}

TEST_CASE("energy of an isolated bonded packing over 10 000 steps") {
  const Spheres s = jittered(5);
  Scene scene;
  scene.grains(s.x, s.r, elastic_material());
  scene.engine.make_bonds(0.35);
  scene.prepare(Geometry::frozen);
  scene.set("velocity", random_field(s.x.size(), 0.1, 3));
  scene.set("spin", random_field(s.x.size(), 0.1, 4));
  const double dt = 0.9 * scene.engine.stable_step();
  scene.step(dt);
  const double before = scene.engine.ledger().balance();
  const std::vector<double> momentum = scene.engine.momentum();
  double worst = 0.0;
  for (int k = 0; k < 100; ++k) {
    scene.step(dt, 100);
    worst = std::max(worst, std::fabs(scene.engine.ledger().balance() / before - 1.0));
  }
  CHECK(worst < 1e-12);
  CHECK(scene.energy("elastic") > 0.1 * before);
  CHECK(scene.energy("rotational") > 0.05 * before);
  const std::vector<double> after = scene.engine.momentum();
  for (int c = 0; c < 3; ++c) CHECK(after[c] == Approx(momentum[c]).margin(1e-12 * momentum[6]));
}

TEST_CASE("energy with gravity, loads, dashpots, damping, constraints closes") {
  const Spheres s = jittered(4);
  Scene scene;
  scene.engine.options.gravity = vec(0, 0, -9.81);
  scene.grains(s.x, s.r, elastic_material());
  scene.engine.make_bonds(0.35);
  std::vector<std::int32_t> bottom, top;
  for (int i = 0; i < 16; ++i) bottom.push_back(i), top.push_back(48 + i);
  using gabion::engine::History;
  scene.engine.boundary.add({"base", bottom, 12, vec(0, 0, 1), History("half_sine", {0.01, 0.0, 0.05})}, 64);
  scene.engine.boundary.add({"push", top, VecField(16, vec(3, 0, -5)), History("ramp", {1.0, 0.0, 0.02})}, 64);
  scene.engine.boundary.add(gabion::engine::Dashpot{"absorb", top, VecField(16, vec(100, 200, 300))}, 64);
  scene.prepare(Geometry::frozen);
  const double dt = 0.7 * scene.engine.stable_step();
  scene.step(dt);
  const double before = scene.engine.ledger().balance();
  double largest = 0.0;
  for (int k = 0; k < 20; ++k) {
    scene.step(dt, 20, 0.2);
    const auto ledger = scene.engine.ledger();
    for (const auto& entry : ledger.entries) largest = std::max(largest, std::fabs(entry.energy));
    CHECK(std::fabs(scene.engine.ledger().balance() - before) < 1e-11 * largest);
  }
  for (const char* name : {"damping", "dashpots", "loads", "constraints"})
    CHECK(std::fabs(scene.energy(name)) > 1e-6 * largest);
}

TEST_CASE("the stable step against dense eigenvalues, and against the blow-up") {
  for (const bool rotating : {true, false}) {
    const Spheres s = jittered(3, 5);
    Scene scene;
    scene.grains(s.x, s.r, elastic_material());
    scene.engine.make_bonds(0.35);
    scene.engine.boundary.add({"hold", {0, 3}, 9, vec(0, 0, 0), {}}, s.x.size());
    scene.prepare(Geometry::frozen, rotating);
    DemEngine& e = scene.engine;
    // columns of K from unit displacements and rotations
    const std::size_t n = s.x.size(), per = rotating ? 6 : 3;
    LinearNetwork network;
    network.build(e.contacts(), VecField(n, Vec{}), 0.0);
    Eigen::MatrixXd a(per * n, per * n);
    const auto root = [&](std::size_t i, std::size_t axis) {
      if (axis < 3) return std::sqrt(e.motion.freedom[i][axis] / e.motion.mass[i]);
      return std::sqrt(e.rotation().mobility[i]);
    };
    for (std::size_t column = 0; column < per * n; ++column) {
      VecField u(n, Vec{}), w(n, Vec{}), f(n, Vec{}), t(n, Vec{});
      const std::size_t i = column / per, axis = column % per;
      (axis < 3 ? u : w)[i][axis % 3] = root(i, axis);
      network.add_forces(0, n, u, w, f, t, rotating, 1);
      for (std::size_t row = 0; row < per * n; ++row) {
        const std::size_t k = row / per, b = row % per;
        a(row, column) = -root(k, b) * (b < 3 ? f : t)[k][b % 3];
      }
    }
    CHECK((a - a.transpose()).norm() < 1e-12 * a.norm());
    const double highest = Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(a).eigenvalues().maxCoeff();
    const double exact = 2.0 / std::sqrt(highest), found = e.stable_step();
    CHECK(found <= exact * (1.0 + 1e-9));
    CHECK(found > 0.999 * exact);

    const auto growth = [&](double share) {
      Scene run;
      run.grains(s.x, s.r, elastic_material());
      run.engine.make_bonds(0.35);
      run.engine.boundary.add({"hold", {0, 3}, 9, vec(0, 0, 0), {}}, n);
      run.prepare(Geometry::frozen, rotating);
      run.set("displacement", random_field(n, 1e-9, 8));
      run.step(share * exact);
      const double start = run.energy("kinetic") + run.energy("elastic");
      double most = 0.0;
      for (int k = 0; k < 50; ++k) {
        run.step(share * exact, 20);
        most = std::max(most, run.engine.motion.largest_speed());
        if (most > 1e-2) break;  // started with 1e-9 m
      }
      return most / std::sqrt(start / run.engine.motion.mass[0]);
    };
    CHECK(growth(0.99) < 100.0);
    CHECK(growth(1.01) > 1e4);
  }
}

TEST_CASE("one and two threads give the same bits") {
  for (const Geometry geometry : {Geometry::frozen, Geometry::updated}) {
    std::uint64_t hashes[2];
    for (const int threads : {1, 2}) {
      const Spheres s = jittered(10);
      Scene scene;
      scene.periodic_box(vec(-.5, -.5, -.5), vec(9.5, 9.5, 9.5));
      scene.engine.threads = threads;
      scene.grains(s.x, s.r, elastic_material());
      scene.engine.make_bonds(0.35);
      scene.prepare(geometry);
      scene.set("velocity", random_field(s.x.size(), 1.0, 3));
      scene.step(0.8 * scene.engine.stable_step(), 20, 0.1);
      hashes[threads - 1] = scene.engine.state_hash();
    }
    CHECK(hashes[0] == hashes[1]);
  }
}

TEST_CASE("frozen geometry refuses what it cannot do") {
  const Spheres s = jittered(2);
  Scene scene;
  GrainMaterial weak = elastic_material();
  weak.normal_strength = 1e5;
  scene.grains(s.x, s.r, weak);
  CHECK_THROWS_WITH(scene.prepare(Geometry::frozen), Catch::Contains("needs bonds"));
  scene.engine.make_bonds(0.35);
  CHECK_THROWS_WITH(scene.prepare(Geometry::frozen), Catch::Contains("cannot break"));
  scene.engine.set_materials({elastic_material()});
  scene.engine.set_walls({Wall{vec(0, 0, -5), vec(0, 0, 1), 0.0, vec(0, 0, 0), {}, {}}});
  CHECK_THROWS_WITH(scene.prepare(Geometry::frozen), Catch::Contains("walls"));
}
