// The rigid block: geometry, free motion, contact.

#include "dem_server/polyhedron.hpp"
#include "fixture.hpp"

using namespace gabion::dem;
using namespace gabion::dem::testing;

namespace {

/// A box of sides a, b, c about a centre.
BlockSetup box(Vec centre, double a, double b, double c, double mass) {
  BlockSetup setup;
  for (int v = 0; v < 8; ++v)
    setup.vertices.push_back(centre + vec((v & 1 ? .5 : -.5) * a, (v & 2 ? .5 : -.5) * b, (v & 4 ? .5 : -.5) * c));
  setup.face_ptr = {0, 4, 8, 12, 16, 20, 24};
  setup.face_vertices = {0, 2, 3, 1, 4, 5, 7, 6, 0, 1, 5, 4, 2, 6, 7, 3, 0, 4, 6, 2, 1, 3, 7, 5};
  setup.mass = mass;
  setup.friction = 0.5;
  return setup;
}

}  // namespace

TEST_CASE("mass properties of a box and nearest points") {
  const BlockSetup setup = box(vec(3, -2, 5), 1, 2, 3, 1);
  const Polyhedron body(setup.vertices, setup.face_ptr, setup.face_vertices);
  CHECK(body.volume == Approx(6.0).epsilon(1e-12));
  CHECK(norm(body.centroid - vec(3, -2, 5)) < 1e-12);
  CHECK(body.inertia[0][0] == Approx((4 + 9) / 12.0));
  CHECK(body.inertia[1][1] == Approx((1 + 9) / 12.0));
  CHECK(body.inertia[2][2] == Approx((1 + 4) / 12.0));
  CHECK(body.inertia[0][1] == Approx(0.0).margin(1e-12));

  const auto near = [&](Vec x) { return nearest_point(body, vec(3, -2, 5) + x); };
  CHECK(near(vec(1.5, 0.3, 0.2)).distance == Approx(1.0));             // face
  CHECK(near(vec(1.5, 2.0, 0.2)).distance == Approx(std::sqrt(2.0)));  // edge
  CHECK(near(vec(1.5, 2.0, 2.5)).distance == Approx(std::sqrt(3.0)));  // corner
  CHECK(near(vec(0.4, 0.0, 0.0)).distance == Approx(-0.1));            // inside
  CHECK(near(vec(0.4, 0.0, 0.0)).outward[0] == Approx(1.0));
  CHECK(near(vec(1.5, 2.0, 2.5)).outward[2] == Approx(1 / std::sqrt(3.0)));

  BlockSetup open = setup;
  open.face_ptr.pop_back();
  open.face_vertices.resize(20);
  CHECK_THROWS_WITH(Polyhedron(open.vertices, open.face_ptr, open.face_vertices), Catch::Contains("edge"));
  BlockSetup dented = setup;
  dented.vertices[7] = vec(3, -2, 5);
  CHECK_THROWS_WITH(Polyhedron(dented.vertices, dented.face_ptr, dented.face_vertices), Catch::Contains("convex"));
}

TEST_CASE("a free block falls and spins as it should") {
  Scene s;
  s.engine.options.gravity = vec(0, 0, -10);
  s.grains({vec(100, 0, 0)}, {0.5}, frictional_material(0.1));
  BlockSetup setup = box(vec(0, 0, 0), 1, 2, 3, 6);
  setup.velocity = vec(1, 0, 0);
  setup.spin = vec(0, 0.01, 2);  // near the stiff axis: it must stay there, its momentum too
  s.engine.set_block(setup);
  s.prepare(Geometry::updated);
  const std::vector<double> before = s.engine.momentum();
  const double dt = 1e-3;
  s.step(dt, 1000);
  const std::vector<double> state = s.engine.block().state();
  CHECK(state[0] == Approx(1.0));
  CHECK(state[2] == Approx(-5.0).epsilon(2e-3));
  // angular momentum about the block's own centre is constant
  const Vec L = s.engine.block().now.momentum;
  CHECK(L[2] == Approx(6 * (1 + 4) / 12.0 * 2).epsilon(1e-12));
  const double energy = s.engine.block().rotational_energy();
  const double expected = 0.5 * 6 * ((1 + 4) / 12.0 * 4 + (1 + 9) / 12.0 * 1e-4);
  CHECK(energy == Approx(expected).epsilon(1e-5));
  CHECK(before.size() == 7);
}

TEST_CASE("a block on three grains carries its weight and slides with friction") {
  for (const bool sliding : {false, true}) {
    Scene s;
    s.engine.options.gravity = vec(0, 0, -10);
    const VecField x{vec(-1, -1, 0), vec(1, -1, 0), vec(0, 1, 0)};
    s.grains(x, {0.5, 0.5, 0.5}, frictional_material(0.1));
    s.engine.boundary.add({"hold", {0, 1, 2}, 15, vec(0, 0, 0), {}}, 3);
    BlockSetup setup = box(vec(0, 0, 1.0), 4, 4, 1, 100);
    s.engine.set_block(setup);
    s.prepare(Geometry::updated);
    const double dt = 0.1 * s.engine.stable_step();
    s.step(dt, 20000, 0.5);
    double weight = 0.0;
    for (const SurfaceContact& c : s.engine.block().contacts) weight -= c.force[2];
    CHECK(weight == Approx(1000.0).epsilon(1e-4));
    CHECK(s.engine.block().contacts.size() == 3);
    if (!sliding) continue;
    // an outside push is not part of the interface: give it speed instead; it stops after v^2/(2 mu g)
    const double sag = 1000.0 / 3 / (0.5 * 1e6 * 0.5);  // weight over three contacts
    setup = box(vec(0, 0, 1.0 - sag), 4, 4, 1, 100);
    setup.rotation = false;
    setup.velocity = vec(0.5, 0, 0);
    s.engine.set_block(setup);
    s.engine.prepare();
    s.step(dt, static_cast<int>(0.3 / dt));
    // the shear springs keep swinging: friction took the rest
    CHECK(s.energy("friction") == Approx(0.5 * 100 * 0.25).epsilon(0.1));
    CHECK(s.engine.block().now.displacement[0] == Approx(0.25 / (2 * 0.5 * 10)).epsilon(0.1));
  }
}

TEST_CASE("a cube falls on its tip into grains: momentum and energy are accounted for") {
  Scene s;
  Spheres grains = jittered(6);
  for (double& r : grains.r) r = 0.499 * 0.92;
  s.grains(grains.x, grains.r, frictional_material(0.5));
  BlockSetup setup = box(vec(0, 0, 0), 1.5, 1.5, 1.5, 3000);
  // stand it on a corner: turn the diagonal to -z
  const Vec axis = vec(1, -1, 0) * splat(std::sqrt(0.5));
  const double angle = -std::acos(1 / std::sqrt(3.0));
  for (Vec& v : setup.vertices) {
    const Vec along = axis * splat(dot(axis, v));
    v = along + splat(std::cos(angle)) * (v - along) + splat(std::sin(angle)) * cross(axis, v) + vec(2.4, 2.6, 6.8);
  }
  setup.velocity = vec(0, 0, -3);
  setup.spin = vec(0.3, 0.1, 0.2);
  s.engine.set_block(setup);
  s.prepare(Geometry::updated);
  const double dt = 0.05 * s.engine.stable_step();
  s.step(dt);
  const double before = s.engine.ledger().balance();
  const std::vector<double> momentum = s.engine.momentum();
  double most = 0;
  for (int k = 0; k < 60; ++k) {
    s.step(dt, 100);
    most = std::max(most, s.count("surface_contacts"));
  }
  CHECK(most > 0);
  const std::vector<double> after = s.engine.momentum();
  for (int c = 0; c < 3; ++c) CHECK(after[c] == Approx(momentum[c]).margin(1e-12 * momentum[6]));
  for (int c = 3; c < 6; ++c) CHECK(after[c] == Approx(momentum[c]).margin(1e-9 * 10 * momentum[6]));
  CHECK(s.energy("friction") > 1e-3 * before);
  CHECK(s.engine.ledger().balance() == Approx(before).epsilon(2e-3));
}

TEST_CASE("a block checkpoint resumes bit for bit") {
  const auto make = [](Scene& s) {
    Spheres grains = jittered(4);
    s.grains(grains.x, grains.r, frictional_material(0.5));
    BlockSetup setup = box(vec(1.5, 1.6, 4.25), 1.5, 1.5, 1.5, 3000);
    setup.velocity = vec(0.1, 0, -3);
    setup.spin = vec(0.3, 0.1, 0.2);
    s.engine.set_block(setup);
    s.prepare(Geometry::updated);
  };
  Scene whole, first, second;
  make(whole);
  make(first);
  make(second);
  const double dt = 0.2 * whole.engine.stable_step();
  int steps = 0;
  while (first.count("surface_contacts") < 2 && steps < 2000) first.step(dt), ++steps;
  REQUIRE(first.count("surface_contacts") >= 2);
  second.engine.restore(first.engine.checkpoint());
  second.time = first.time;
  second.step(dt, 500);
  whole.step(dt, steps + 500);
  CHECK(second.energy("friction") > 0.0);
  CHECK(second.engine.state_hash() == whole.engine.state_hash());
}
