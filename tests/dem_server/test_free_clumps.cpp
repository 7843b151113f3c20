// Clumps as free bodies: rotation, fall, impact on a wall.

#include <Eigen/Dense>

#include "clump_fixture.hpp"

using namespace gabion::dem;
using namespace gabion::dem::testing;

TEST_CASE("a free asymmetric clump keeps energy, angular momentum and shape, and tumbles as Euler's equations say") {
  const Spheres s = odd_clump();
  Scene scene;
  scene.grains(s.x, s.r, elastic_material());
  const Clumped made = scene.engine.make_clumps(clumps_of(4));
  REQUIRE((made.clumps == 1 && made.grains == 4));
  scene.prepare(Geometry::updated);
  // inertia about the centre, and its middle axis, about which rotation is unstable
  Eigen::Matrix3d inertia = Eigen::Matrix3d::Zero();
  double mass = 0.0;
  Vec centre{};
  const auto& m = scene.engine.motion.mass;
  for (int i = 0; i < 4; ++i) mass += m[i], centre += splat(m[i]) * s.x[i];
  centre /= splat(mass);
  for (int i = 0; i < 4; ++i) {
    const Vec a = s.x[i] - centre;
    const Eigen::Vector3d e(a[0], a[1], a[2]);
    inertia += m[i] * (e.squaredNorm() * Eigen::Matrix3d::Identity() - e * e.transpose());
    inertia += 0.4 * m[i] * s.r[i] * s.r[i] * Eigen::Matrix3d::Identity();
  }
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> principal(inertia);
  REQUIRE(principal.eigenvalues()(0) < 0.9 * principal.eigenvalues()(1));
  const double dt = 1e-3;
  const Eigen::Vector3d start = 10.0 * principal.eigenvectors().col(1) + 1.0 * principal.eigenvectors().col(0);
  const Vec spin = vec(start(0), start(1), start(2)), velocity = vec(0.3, -0.2, 0.1);
  scene.set("velocity", rigid_velocity(s, velocity, spin, centre));
  scene.set("spin", VecField(4, spin));
  scene.step(dt);
  const std::vector<double> before = scene.engine.momentum();
  const double energy = scene.engine.ledger().balance(), rotational = scene.energy("rotational");
  CHECK(rotational == Approx(0.5 * start.dot(inertia * start)).epsilon(1e-4));
  double least = rotational, most = rotational;
  for (int k = 0; k < 100; ++k) {
    scene.step(dt, 100);
    least = std::min(least, scene.energy("rotational"));
    most = std::max(most, scene.energy("rotational"));
  }
  CHECK(most - least < 2e-4 * rotational);  // swings with (omega dt)^2 = 1e-4
  CHECK(scene.engine.ledger().balance() == Approx(energy).epsilon(1e-4));
  const std::vector<double> after = scene.engine.momentum();
  const double scale = norm(vec(before[3], before[4], before[5]));
  for (int c = 0; c < 6; ++c) CHECK(after[c] == Approx(before[c]).margin(1e-11 * scale));
  for (int i = 0; i < 4; ++i)
    for (int j = 0; j < i; ++j) {
      const auto& u = scene.engine.motion.displacement;
      CHECK(norm(s.x[i] + u[i] - s.x[j] - u[j]) == Approx(norm(s.x[i] - s.x[j])).epsilon(1e-13));
    }

  // the turn-over of the middle axis, against Euler's equations by Runge and Kutta's fourth order
  Scene again;
  again.grains(s.x, s.r, elastic_material());
  again.engine.make_clumps(clumps_of(4));
  again.prepare(Geometry::updated);
  again.set("spin", VecField(4, spin));
  const Eigen::Matrix3d inverse = inertia.inverse();
  Eigen::Vector3d w = start;  // in the body
  Eigen::Matrix3d turn = Eigen::Matrix3d::Identity();
  const auto rate = [&](const Eigen::Vector3d& o) -> Eigen::Vector3d { return inverse * (inertia * o).cross(o); };
  const auto spinning = [](const Eigen::Matrix3d& r, const Eigen::Vector3d& o) -> Eigen::Matrix3d {
    Eigen::Matrix3d cross;
    cross << 0, -o(2), o(1), o(2), 0, -o(0), -o(1), o(0), 0;
    return r * cross;
  };
  const int steps = 3000;
  const double h = dt;
  double turned_over = 1.0;
  for (int k = 0; k < steps; ++k) {
    const Eigen::Vector3d k1 = rate(w), k2 = rate(w + 0.5 * h * k1), k3 = rate(w + 0.5 * h * k2), k4 = rate(w + h * k3);
    const Eigen::Matrix3d r1 = spinning(turn, w), r2 = spinning(turn + 0.5 * h * r1, w + 0.5 * h * k1),
                          r3 = spinning(turn + 0.5 * h * r2, w + 0.5 * h * k2),
                          r4 = spinning(turn + h * r3, w + h * k3);
    turn += h / 6.0 * (r1 + 2 * r2 + 2 * r3 + r4);
    w += h / 6.0 * (k1 + 2 * k2 + 2 * k3 + k4);
    turned_over = std::min(turned_over, w.normalized().dot(start.normalized()));
  }
  CHECK(turned_over < -0.9);
  again.step(dt, steps);
  for (int i = 0; i < 4; ++i) {
    const Vec arm = s.x[i] - centre, place = arm + again.engine.motion.displacement[i];
    const Eigen::Vector3d expected = turn * Eigen::Vector3d(arm[0], arm[1], arm[2]);
    CHECK(norm(place - vec(expected(0), expected(1), expected(2))) < 1e-4);
  }
}

TEST_CASE("a clump falls freely without turning") {
  const Spheres s = odd_clump();
  Scene scene;
  scene.engine.options.gravity = vec(0, 0, -10);
  scene.grains(s.x, s.r, elastic_material());
  scene.engine.make_clumps(clumps_of(4));
  scene.prepare(Geometry::updated);
  const double dt = 1e-3;
  const int steps = 1000;
  scene.step(dt, steps);
  for (int i = 0; i < 4; ++i) {
    // leapfrog from v(-1/2) = 0
    CHECK(scene.engine.motion.displacement[i][2] == Approx(-10.0 * dt * dt * steps * (steps + 1) / 2).epsilon(1e-12));
    CHECK(norm(scene.spin(i)) < 1e-12);
  }
  CHECK(std::fabs(scene.engine.ledger().balance()) < 1e-6 * scene.energy("kinetic"));
}

TEST_CASE("a dumb-bell that hits a wall at an angle: the rigid body's closed form") {
  for (const double angle : {0.2, 0.6, 1.2}) {
    const double r = 0.5, speed = 1e-3;
    const Vec along = vec(std::cos(angle), 0, std::sin(angle));
    const Spheres s{{vec(0, 0, r + 1e-5), vec(0, 0, r + 1e-5) + splat(2 * r) * along}, {r, r}};
    Scene scene;
    scene.grains(s.x, s.r, frictional_material(0.0));
    scene.engine.make_clumps(clumps_of(2));
    scene.engine.set_walls({wall(vec(0, 0, 0), vec(0, 0, 1), 0.0)});
    scene.prepare(Geometry::updated);
    scene.set("velocity", VecField(2, vec(0, 0, -speed)));
    const double m = scene.engine.motion.mass[0];
    const double dt = 0.02 * scene.engine.stable_step();
    scene.step(dt);
    int left = 400000;
    do scene.step(dt, 10);
    while (scene.count("surface_contacts") == 0 && --left > 0);
    while (scene.count("surface_contacts") > 0 && --left > 0) scene.step(dt, 10);
    REQUIRE(left > 0);
    // r x n of the contact about the centre of mass, frictionless: the force goes through the sphere's centre
    const double inertia = 2 * (0.4 * m * r * r + m * r * r), lever = r * std::cos(angle);
    const double impulse = 2 * speed / (1 / (2 * m) + lever * lever / inertia);
    const double rise = 0.5 * (scene.velocity(0)[2] + scene.velocity(1)[2]);
    CHECK(rise == Approx(-speed + impulse / (2 * m)).margin(1e-3 * speed));
    CHECK(scene.spin(0)[1] * r == Approx(lever * impulse / inertia * r).margin(1e-3 * speed));
    CHECK(norm(scene.spin(0) - scene.spin(1)) == 0.0);
  }
}
