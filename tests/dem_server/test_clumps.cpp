// Rigid clumps: free motion, impact, energy, momentum, the stable step, fields, checkpoints, refusals.

#include <Eigen/Dense>

#include "dem_server/stable_step.hpp"
#include "fixture.hpp"

using namespace gabion::dem;
using namespace gabion::dem::testing;

namespace {

ClumpRequest clumps_of(std::int32_t size, double gap = 0.02) {
  return {{size}, gap, {}};
}

/// Four touching spheres of different sizes, principal inertias all different.
Spheres odd_clump() {
  const double r[4] = {0.5, 0.4, 0.3, 0.35};
  Spheres s;
  s.x = {vec(0, 0, 0), vec(r[0] + r[1], 0, 0)};
  s.x.push_back(vec(0, r[0] + r[2], 0));
  s.x.push_back(s.x[1] + vec(0.6, 0, 0.8) * splat(r[1] + r[3]));
  s.r.assign(r, r + 4);
  return s;
}

Wall wall(Vec point, Vec normal, double friction) {
  Wall w;
  w.point = point;
  w.normal = normal;
  w.friction = friction;
  return w;
}

VecField rigid_velocity(const Spheres& s, Vec velocity, Vec spin, Vec about) {
  VecField v;
  for (const Vec x : s.x) v.push_back(velocity + cross(spin, x - about));
  return v;
}

/// Loose spheres above a floor and between four walls, joined to clumps.
void heap(Scene& scene, double friction, std::int32_t size, int threads = 1, double strength = 0.0) {
  Spheres s = jittered(5, 4);
  for (double& r : s.r) r *= 0.95;
  GrainMaterial material = frictional_material(friction);
  material.normal_strength = strength;
  material.shear_strength = strength;
  scene.engine.threads = threads;
  scene.engine.options.gravity = vec(0.5, 0, -10);
  scene.grains(s.x, s.r, material);
  scene.engine.make_clumps(clumps_of(size, 0.35));
  if (strength > 0.0) scene.engine.make_bonds(0.35);
  std::vector<Wall> walls;
  for (const auto& [point, normal] : {std::pair{vec(0, 0, -1), vec(0, 0, 1)},
                                      {vec(-1, 0, 0), vec(1, 0, 0)},
                                      {vec(5, 0, 0), vec(-1, 0, 0)},
                                      {vec(0, -1, 0), vec(0, 1, 0)},
                                      {vec(0, 5, 0), vec(0, -1, 0)}})
    walls.push_back(wall(point, normal, friction));
  scene.engine.set_walls(walls);
  scene.prepare(Geometry::updated);
  scene.set("velocity", random_field(s.x.size(), 1.0, 6));
}

double largest_energy(const Scene& scene) {
  double largest = 0.0;
  for (const auto& entry : scene.engine.ledger().entries) largest = std::max(largest, std::fabs(entry.energy));
  return largest;
}

}  // namespace

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

TEST_CASE("the energy of a heap of clumps is accounted for, with and without friction") {
  for (const double friction : {0.0, 0.4}) {
    Scene scene;
    heap(scene, friction, 4);
    CHECK(scene.count("clumps") > 20);
    // single spheres are off by 5e-4 at this step; a quarter of it at half the step
    const double dt = 0.05 * scene.engine.stable_step();
    scene.step(dt);
    const double before = scene.engine.ledger().balance();
    double largest = 0.0, worst = 0.0, touching = 0.0;
    for (int k = 0; k < 40; ++k) {
      scene.step(dt, 200);
      largest = std::max(largest, largest_energy(scene));
      worst = std::max(worst, std::fabs(scene.engine.ledger().balance() - before));
      touching = std::max(touching, scene.count("contacts"));
    }
    CHECK(touching > 30);
    CHECK((friction > 0.0) == (scene.energy("friction") > 0.02 * largest));
    INFO("friction " << friction << ": " << worst / largest);
    CHECK(worst < 5e-4 * largest);
  }
}

TEST_CASE("local damping acts on force and moment of the body, and the balance closes") {
  Scene scene;
  heap(scene, 0.4, 4);
  const double dt = 0.1 * scene.engine.stable_step();
  scene.step(dt, 1, 0.5);
  const double before = scene.engine.ledger().balance();
  scene.step(dt, 4000, 0.5);
  CHECK(scene.energy("damping") > 0.1 * largest_energy(scene));
  CHECK(scene.engine.ledger().balance() == Approx(before).margin(1e-3 * largest_energy(scene)));
}

TEST_CASE("bonded clumps that spin as a whole keep momentum, angular momentum and energy") {
  Spheres s = jittered(3, 2);
  Scene scene;
  scene.grains(s.x, s.r, elastic_material());
  REQUIRE(scene.engine.make_clumps(clumps_of(3, 0.35)).clumps > 5);
  scene.engine.make_bonds(0.35);
  scene.prepare(Geometry::updated);
  VecField v = rigid_velocity(s, vec(0.1, 0, 0), vec(0.2, -0.3, 0.4), vec(1, 1, 1));
  const VecField noise = random_field(s.x.size(), 0.2, 8);
  for (std::size_t i = 0; i < v.size(); ++i) v[i] += noise[i];
  scene.set("velocity", v);
  const double dt = 0.1 * scene.engine.stable_step();
  scene.step(dt);
  const std::vector<double> before = scene.engine.momentum();
  const double energy = scene.engine.ledger().balance();
  scene.step(dt, 3000);
  CHECK(scene.energy("elastic") > 1e-3 * energy);
  const std::vector<double> after = scene.engine.momentum();
  for (int c = 0; c < 6; ++c) CHECK(after[c] == Approx(before[c]).margin(1e-11 * before[6]));
  CHECK(scene.engine.ledger().balance() == Approx(energy).epsilon(1e-4));
}

TEST_CASE("threads give the same bits with clumps") {
  Scene one, two;
  heap(one, 0.3, 3, 1, 2e4);
  heap(two, 0.3, 3, 2, 2e4);
  const double dt = 0.3 * one.engine.stable_step();
  for (Scene* scene : {&one, &two}) scene->step(dt, 100, 0.1);
  CHECK(one.count("broken") > 0);
  CHECK(one.engine.state_hash() == two.engine.state_hash());
  CHECK(one.energy("friction") == two.energy("friction"));
}

TEST_CASE("a checkpoint with clumps resumes bit for bit, and fits no other clumps") {
  Scene whole, first, second, other;
  for (Scene* scene : {&whole, &first, &second}) heap(*scene, 0.3, 3, 1, 2e4);
  heap(other, 0.3, 4, 1, 2e4);
  const double dt = 0.3 * whole.engine.stable_step();
  whole.step(dt, 500, 0.1);
  first.step(dt, 200, 0.1);
  second.step(dt, 30);
  const auto blob = first.engine.checkpoint();
  second.engine.restore(blob);
  CHECK(second.engine.state_hash() == first.engine.state_hash());
  second.time = first.time;
  second.step(dt, 300, 0.1);
  CHECK(second.engine.state_hash() == whole.engine.state_hash());
  for (const char* name : {"kinetic", "rotational", "friction", "damping"})
    CHECK(second.energy(name) == whole.energy(name));
  CHECK_THROWS_WITH(other.engine.restore(blob), Catch::Contains("other clumps"));
}

TEST_CASE("clumps of one sphere are single spheres: the same bits") {
  Scene with, without;
  heap(with, 0.3, 1);
  Spheres s = jittered(5, 4);
  heap(without, 0.3, 2);
  CHECK_FALSE(without.engine.clumps().empty());
  without.engine.make_clumps(clumps_of(1));
  without.prepare(Geometry::updated);
  without.set("velocity", random_field(s.x.size(), 1.0, 6));
  without.set("spin", VecField(s.x.size(), Vec{}));
  const double dt = 0.3 * with.engine.stable_step();
  with.step(dt, 300, 0.1);
  without.step(dt, 300, 0.1);
  CHECK(with.engine.clumps().empty());
  CHECK(with.engine.state_hash() == without.engine.state_hash());

  Scene plain;  // never heard of clumps
  Spheres loose = jittered(4);
  for (Scene* scene : {&plain, &with}) {
    scene->engine.options.gravity = vec(0, 0, -10);
    scene->engine.set_walls({wall(vec(0, 0, -0.5), vec(0, 0, 1), 0.3)});
    scene->grains(loose.x, loose.r, frictional_material(0.3));
    if (scene == &with) CHECK(scene->engine.make_clumps(clumps_of(1)).clumps == 0);
    scene->prepare(Geometry::updated);
    scene->step(1e-3, 500);
  }
  CHECK(plain.engine.state_hash() == with.engine.state_hash());
}

TEST_CASE("the stable step with clumps is that of the bodies: closed form, and where leapfrog blows up") {
  // two dumb-bells in a line, bonded end to end: along it omega^2 = k (1/2m + 1/2m)
  const double r = 0.5;
  GrainMaterial material = elastic_material();
  material.shear_stiffness = 0.0;
  Scene pair;
  pair.grains({vec(0, 0, 0), vec(1, 0, 0), vec(2, 0, 0), vec(3, 0, 0)}, {r, r, r, r}, material);
  REQUIRE(pair.engine.make_clumps(clumps_of(2)).clumps == 2);
  CHECK(pair.engine.make_bonds(0.01).bonds == 1);
  pair.prepare(Geometry::updated);
  LinearNetwork network;
  network.build(pair.engine.contacts(), pair.engine.motion.displacement, 0.0);
  const double k = 0.5 * material.normal_stiffness * r, m = pair.engine.motion.mass[0];
  const Spectrum spectrum =
      highest_eigenvalue(network, pair.engine.motion, pair.engine.rotation(), true, &pair.engine.clumps());
  CHECK(spectrum.highest == Approx(k / m).epsilon(1e-6));

  Spheres s = jittered(4, 3);
  for (const double share : {0.98, 1.02}) {
    Scene scene;
    scene.grains(s.x, s.r, elastic_material());
    scene.engine.make_clumps(clumps_of(4, 0.35));
    scene.engine.make_bonds(0.35);
    scene.prepare(Geometry::updated);
    scene.set("velocity", random_field(s.x.size(), 1e-9, 8));
    LinearNetwork springs;
    springs.build(scene.engine.contacts(), scene.engine.motion.displacement, 0.0);
    const double limit = 2.0 / std::sqrt(highest_eigenvalue(springs, scene.engine.motion, scene.engine.rotation(), true,
                                                            &scene.engine.clumps())
                                             .highest);
    CHECK(scene.engine.stable_step() <= 1.0001 * limit);
    const double speed = scene.engine.motion.largest_speed();
    scene.step(share * limit, 40);
    if (share < 1.0)
      CHECK(scene.engine.motion.largest_speed() < 20 * speed);
    else
      CHECK(scene.engine.motion.largest_speed() > 1e3 * speed);
  }
}

TEST_CASE("a clump at rest is balanced though its members are not") {
  // two spheres on the floor carry the third
  const double r = 0.5;
  const Spheres s{{vec(0, 0, r), vec(1, 0, r), vec(0.5, 0, r + std::sqrt(0.75))}, {r, r, r}};
  Scene scene;
  scene.engine.options.gravity = vec(0, 0, -10);
  scene.grains(s.x, s.r, frictional_material(0.5));
  REQUIRE(scene.engine.make_clumps(clumps_of(3)).clumps == 1);
  scene.engine.set_walls({wall(vec(0, 0, 0), vec(0, 0, 1), 0.5)});
  scene.prepare(Geometry::updated);
  scene.step(0.2 * scene.engine.stable_step(), 5000, 0.6);
  CHECK(scene.engine.motion.mean_unbalanced_force() > 0.3 * scene.engine.motion.mass[0] * 10);
  CHECK(scene.engine.unbalanced() < 1e-6);
  CHECK(scene.count("surface_contacts") == 2);
}

TEST_CASE("fields that are set become the nearest rigid motion") {
  const Spheres s = odd_clump();
  const auto prepared = [&](Scene& scene) {
    scene.grains(s.x, s.r, elastic_material());
    scene.engine.make_clumps(clumps_of(4));
    scene.prepare(Geometry::updated);
  };
  Scene scene;
  prepared(scene);
  const Vec velocity = vec(1, 2, 3), spin = vec(0.3, -0.2, 0.5);
  const VecField rigid = rigid_velocity(s, velocity, spin, vec(0.2, 0.1, 0));
  for (const bool spin_first : {true, false}) {
    if (spin_first) scene.set("spin", VecField(4, spin));
    scene.set("velocity", rigid);
    if (!spin_first) scene.set("spin", VecField(4, spin));
    for (int i = 0; i < 4; ++i) {
      CHECK(norm(scene.velocity(i) - rigid[i]) < 1e-12);
      CHECK(norm(scene.spin(i) - spin) < 1e-12);
    }
  }
  // anything else keeps momentum and angular momentum
  Scene noisy;
  prepared(noisy);
  const VecField noise = random_field(4, 1.0, 2);
  Vec linear{}, angular{};
  for (int i = 0; i < 4; ++i) {
    const Vec p = splat(noisy.engine.motion.mass[i]) * noise[i];
    linear += p;
    angular += cross(s.x[i], p);
  }
  noisy.set("velocity", noise);
  const std::vector<double> got = noisy.engine.momentum();
  for (int c = 0; c < 3; ++c) {
    CHECK(got[c] == Approx(linear[c]).epsilon(1e-12));
    CHECK(got[3 + c] == Approx(angular[c]).epsilon(1e-12));
  }
  // a finite rotation, and one of a small part of a radian, come back
  for (const double size : {1.0, 1e-7}) {
    const Vec axis = vec(0.6, 0, 0.8), about = vec(1, 1, 1);
    VecField u;
    for (const Vec x : s.x) {
      const Vec d = x - about, across = d - axis * splat(dot(axis, d));
      const double half = std::sin(0.5 * size);
      u.push_back(splat(std::sin(size)) * cross(axis, d) - splat(2 * half * half) * across + vec(0, 0, size));
    }
    noisy.set("displacement", u);
    for (int i = 0; i < 4; ++i) CHECK(norm(noisy.engine.motion.displacement[i] - u[i]) < 1e-8 * size);
  }
  std::vector<std::uint64_t> shape;
  CHECK(*noisy.engine.field("clump", shape) == std::vector<double>(4, 0.0));
}

TEST_CASE("a clump of grains that may not turn does not turn") {
  const Spheres s{{vec(0, 0, 0.51), vec(0.8, 0, 1.11)}, {0.5, 0.5}};
  for (const bool by_constraint : {true, false}) {
    Scene scene;
    scene.grains(s.x, s.r, frictional_material(0.3));
    REQUIRE(scene.engine.make_clumps(clumps_of(2)).clumps == 1);
    scene.engine.set_walls({wall(vec(0, 0, 0), vec(0, 0, 1), 0.3)});
    if (by_constraint) scene.engine.boundary.add({"turn", {0, 1}, 8, vec(0, 0, 0), {}}, 2);
    scene.prepare(Geometry::updated, by_constraint);
    scene.set("velocity", VecField(2, vec(0, 0, -0.2)));
    const double dt = 0.02 * scene.engine.stable_step();
    scene.step(dt);
    const double before = scene.engine.ledger().balance();
    scene.step(dt, 4000);
    // bounces back like one sphere of twice the mass
    for (int i = 0; i < 2; ++i) {
      CHECK(scene.velocity(i)[2] == Approx(0.2).epsilon(1e-3));
      CHECK(norm(scene.spin(i)) == 0.0);
    }
    CHECK(scene.engine.ledger().balance() == Approx(before).epsilon(1e-3));
  }
}

TEST_CASE("what clumps cannot do is refused by name") {
  const Spheres s{{vec(0, 0, 0), vec(1, 0, 0), vec(2, 0, 0), vec(3, 0, 0)}, {0.5, 0.5, 0.5, 0.5}};
  const auto made = [&](Scene& scene, Geometry geometry = Geometry::updated) {
    scene.grains(s.x, s.r, elastic_material());
    scene.engine.make_clumps(clumps_of(2));
    scene.engine.make_bonds(0.01);
    scene.prepare(geometry);
  };
  Scene scene;
  CHECK_THROWS_WITH(scene.engine.make_clumps(clumps_of(2)), Catch::Contains("no grains"));
  CHECK_THROWS_WITH(made(scene, Geometry::frozen), Catch::Contains("no clumps"));
  CHECK_THROWS_WITH(scene.engine.make_clumps(clumps_of(0)), Catch::Contains("clumps of 0"));
  CHECK_THROWS_WITH(scene.engine.make_clumps({{}, 0.0, {}}), Catch::Contains("none for material 0"));
  CHECK_THROWS_WITH(scene.engine.make_clumps({{2}, 0.0, {4}}), Catch::Contains("grain 4 of 4"));
  CHECK_THROWS_WITH(scene.engine.make_clumps({{2}, 2.0, {}}), Catch::Contains("gap"));
  made(scene);
  scene.step(1e-4);
  scene.engine.boundary.add({"hold", {3}, 4, vec(0, 0, 0), {}}, 4);
  scene.engine.boundary.apply_to(scene.engine.motion);
  CHECK_THROWS_WITH(scene.step(1e-4), Catch::Contains("grain 3 belongs to a clump"));
  CHECK_THROWS_WITH(scene.engine.stable_step(), Catch::Contains("grain 3 belongs to a clump"));
  CHECK_THROWS_WITH(scene.engine.prepare(), Catch::Contains("grain 3 belongs to a clump"));
  Scene dashed;
  made(dashed);
  dashed.engine.boundary.add(gabion::engine::Dashpot{"pot", {0}, {vec(0, 1, 0)}}, 4);
  CHECK_THROWS_WITH(dashed.engine.prepare(), Catch::Contains("grain 0 belongs to a clump"));
  Scene weighted;
  weighted.engine.weights.outer_lo[0] = -1.0;
  weighted.engine.weights.width = 1.5;
  weighted.engine.weights.floor = 0.01;
  CHECK_THROWS_WITH(made(weighted), Catch::Contains("grain 0 belongs to a clump"));
  Scene tied;
  made(tied);
  tied.engine.tie.set(gabion::engine::Tie::Mode::gap, 1, {}, {0, 1}, {1}, {1.0}, tied.engine.motion);
  CHECK_THROWS_WITH(tied.step(1e-4), Catch::Contains("belongs to a clump"));
  // named single, it may be held
  Scene single;
  single.grains(s.x, s.r, elastic_material());
  CHECK(single.engine.make_clumps({{2}, 0.02, {3}}).grains == 3);
  single.engine.boundary.add({"hold", {3}, 4, vec(0, 0, 0), {}}, 4);
  single.prepare(Geometry::updated);
  single.step(1e-4, 10);
}
