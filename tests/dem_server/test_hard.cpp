// Hard cases of grains alone: overlaps at the start, steps longer than the search margin, a bond that breaks where a
// contact takes over, denormals.

#include <xmmintrin.h>

#include "fixture.hpp"
#include "tests/denormals.hpp"
#include "tests/figure.hpp"

using namespace gabion::dem;
using namespace gabion::dem::testing;
using gabion::denormals;
using gabion::figure;

TEST_CASE("grains that overlap at the start get their stored energy and no more, or are refused") {
  const double r = 0.5, k = 0.5 * frictional_material(0.0).normal_stiffness * r;
  double worst = 0.0;
  for (const double overlap : {1e-6, 1e-3, 0.05, 0.099}) {
    CAPTURE(overlap);
    Scene scene;
    scene.grains({vec(0, 0, 0), vec(2 * r - overlap * r, 0, 0)}, {r, r}, frictional_material(0.0));
    scene.prepare(Geometry::updated);
    const double stored = 0.5 * k * overlap * overlap * r * r;
    scene.step(0.02 * scene.engine.stable_step(), 400);
    CHECK(scene.count("contacts") == 0);
    worst = std::max(worst, std::fabs(scene.energy("kinetic") / stored - 1.0));
  }
  CHECK(worst < 5e-3);
  figure("overlap_energy_error", worst);
  Scene refused;
  refused.grains({vec(0, 0, 0), vec(2 * r - 0.6 * r, 0, 0)}, {r, r}, frictional_material(0.0));
  CHECK_THROWS_WITH(refused.prepare(Geometry::updated), Catch::Contains("grains 0 and 1 overlap"));
  // bonded as it stands the same pair is at rest
  Scene bonded;
  bonded.grains({vec(0, 0, 0), vec(2 * r - 0.6 * r, 0, 0)}, {r, r}, elastic_material());
  bonded.engine.make_bonds(0.0);
  bonded.prepare(Geometry::updated);
  bonded.step(0.5 * bonded.engine.stable_step(), 100);
  CHECK(bonded.engine.motion.largest_speed() == 0.0);
}

TEST_CASE("grains that cross the search margin in every step still meet, are counted, and never lost unseen") {
  const double r = 0.5, skin = 1e-4;
  Scene scene;
  scene.engine.options.box_lo = vec(-4, -4, -4);
  scene.engine.options.box_hi = vec(4, 4, 4);
  // a head-on and a grazing pair far apart at first, and one grain that flies away for good
  scene.grains({vec(-1.2, 0, 0), vec(1.2, 0, 0), vec(-1.2, 2.5, 0), vec(1.2, 3.0, 0), vec(0, 0, 3)}, {r, r, r, r, r},
               frictional_material(0.0));
  scene.prepare(Geometry::updated, true, skin);
  const double dt = 0.02 * scene.engine.stable_step(), speed = 5 * skin * r / dt;
  scene.set("velocity", {vec(speed, 0, 0), vec(-speed, 0, 0), vec(speed, 0, 0), vec(-speed, 0, 0), vec(0, 0, 2 * speed)});
  scene.step(dt);
  const double energy = scene.engine.ledger().balance();
  CHECK(scene.count("fast") == 5);
  scene.step(dt, static_cast<int>(3.0 / (speed * dt)));
  CHECK(scene.count("rebuilds") > 1000);
  const double error = std::fabs(scene.velocity(0)[0] / -speed - 1.0);
  CHECK(error < 2e-3);
  CHECK(std::fabs(scene.velocity(2)[1]) > 0.1 * speed);
  CHECK(std::fabs(scene.engine.ledger().balance() / energy - 1.0) < 2e-3);
  CHECK(scene.count("grains") == 5);
  while (scene.time < 16.0 / (2 * speed)) scene.step(dt, 200);
  CHECK(scene.count("lost") == 1);
  std::vector<std::uint64_t> shape;
  CHECK(*scene.engine.field("lost", shape) == std::vector<double>{0, 0, 0, 0, 1});
  figure("fast_rebound_error", error);
  figure("lost_counted", scene.count("lost"));
  // a way longer than the radius could jump over a grain: refused, by name
  scene.set("velocity", {vec(2 * r / dt, 0, 0), vec(0, 0, 0), vec(0, 0, 0), vec(0, 0, 0), vec(0, 0, 0)});
  CHECK_THROWS_WITH(scene.step(dt, 2), Catch::Contains("more than its radius"));
}

TEST_CASE("a bond that breaks under compression while another contact forms: no jump of the force, energy booked") {
  // 0 and 1 are bonded and pressed; 1 is driven sideways until the bond breaks in shear, and meets 2 in that very step
  double jump = 0.0, worst = 0.0;
  int together = 0;
  const double r = 0.5, press = 1e-3, k_n = 0.5 * 1e6 * r, k_s = 0.5 * 4e5 * r;
  GrainMaterial material = frictional_material(0.5);
  material.normal_strength = 1e9;
  const double breaking = 0.8e-3;  // slip at which the bond breaks, m
  material.shear_strength = k_s * breaking / (r * r);
  // early: steps by which the meeting comes sooner. With friction 0.5 the broken contact holds what the bond held, and the
  // whole force goes on; with 0.2 it slides at once
  for (const auto& [early, friction] : {std::pair{-0.3, 0.5}, {0.0, 0.5}, {0.3, 0.5}, {0.0, 0.2}}) {
    Scene scene;
    material.friction = friction;
    const bool slides = friction < 0.3;
    scene.grains({vec(0, 0, 0), vec(0, 0, 1), vec(1.0 + breaking, 0, 1 - press)}, {r, r, r}, material);
    using gabion::engine::History;
    const double speed = 1e-3;
    scene.engine.boundary.add({"floor", {0}, 15, vec(0, 0, 0), {}}, 3);
    scene.engine.boundary.add({"stop", {2}, 15, vec(0, 0, 0), {}}, 3);
    scene.engine.boundary.add({"push", {1}, 15, vec(1, 0, 0), History("constant", {speed})}, 3);
    scene.engine.make_bonds(0.0);
    // only 0 and 1 were touching: pressed now by a displacement
    REQUIRE(scene.engine.bonds().size() == 1);
    scene.prepare(Geometry::updated, false);
    const double dt = 0.01 * scene.engine.stable_step();
    const double start = early * speed * dt;
    scene.set("displacement", {vec(0, 0, 0), vec(start, 0, -press), vec(0, 0, 0)});
    std::vector<std::uint64_t> shape;
    Vec old_force{};
    double first = 0.0;
    bool was_bonded = true, was_touching = false;
    scene.step(dt);
    first = scene.engine.ledger().balance();
    for (int k = 0; k < static_cast<int>(1.5 * breaking / (speed * dt)); ++k) {
      scene.step(dt);
      const bool is_bonded = scene.count("bonds") == 1, is_touching = scene.count("contacts") == 2;
      const double broke = was_bonded && !is_bonded, met = !was_touching && is_touching;
      together += broke && met;
      const auto rows = *scene.engine.field("contact", shape);
      for (std::size_t c = 0; c < rows.size(); c += 8) {
        if (rows[c] != 0 || rows[c + 1] != 1) continue;
        const Vec n = vec(rows[c + 2], rows[c + 3], rows[c + 4]), force = vec(rows[c + 5], rows[c + 6], rows[c + 7]);
        const Vec change = slides ? splat(dot(n, force - old_force)) * n : force - old_force;
        if (k > 0) jump = std::max(jump, norm(change) / (k_n * press));
        old_force = force;
      }
      was_bonded = is_bonded;
      was_touching = is_touching;
      worst = std::max(worst, std::fabs(scene.engine.ledger().balance() - first));
    }
    CHECK(scene.count("broken") == 1);
    CHECK(scene.energy("broken_bonds") > 0.0);
    CHECK((scene.energy("friction") > 0.0) == slides);
    CHECK(scene.count("contacts") == 2);
  }
  const double energy = 0.5 * k_n * press * press;
  CHECK(together >= 1);
  CHECK(jump < 1e-3);
  CHECK(worst < 1e-3 * energy);
  figure("break_force_jump", jump);
  figure("break_balance", worst / energy);
}

TEST_CASE("a change of the step while bonds break is booked") {
  Spheres s = jittered(6);
  for (double& r : s.r) r *= 1.08;
  GrainMaterial material = frictional_material(0.3);
  material.normal_strength = 2e4;
  material.shear_strength = 1e4;
  Scene scene;
  scene.periodic_box(vec(-.5, -.5, -.5), vec(5.5, 5.5, 5.5));
  scene.grains(s.x, s.r, material);
  scene.engine.make_bonds(0.0);
  scene.prepare(Geometry::updated);
  scene.set("velocity", random_field(s.x.size(), 3.0, 3));
  const double limit = scene.engine.stable_step();
  scene.step(0.05 * limit);
  const double before = scene.engine.ledger().balance();
  double worst = 0.0;
  for (const double fraction : {0.05, 0.02, 0.04, 0.01, 0.05}) {
    scene.step(fraction * limit, 300);  // the limit is known again at these moments only
    worst = std::max(worst, std::fabs(scene.engine.ledger().balance() / before - 1.0));
  }
  CHECK(scene.count("broken") > 20);
  CHECK(std::fabs(scene.energy("step_change")) > 0.0);
  CHECK(worst < 1e-3);
  figure("breaking_step_change_balance", worst);
}

TEST_CASE("a grain that is no number is named in the step in which it becomes so") {
  for (const Geometry geometry : {Geometry::frozen, Geometry::updated})
    for (const int threads : {1, 2}) {
      const Spheres s = jittered(4);
      Scene scene;
      scene.engine.threads = threads;
      scene.grains(s.x, s.r, elastic_material());
      scene.engine.make_bonds(0.35);
      scene.prepare(geometry);
      const double dt = 0.5 * scene.engine.stable_step();
      scene.step(dt, 70);
      scene.engine.boundary.add({"sick", {37}, {vec(0, NAN, 0)}, gabion::engine::History("constant", {1.0})}, s.x.size());
      try {
        scene.engine.step({scene.time, dt, 0.0, false}, scene.exchange);
        FAIL("not detected");
      } catch (const gabion::engine::PhysicsError& error) {
        CHECK(error.where == "grain 37");
      }
    }
  figure("steps_until_nan_is_named", 1);
}

TEST_CASE("denormals never appear: ahead of a wave, and where they are put in") {
  std::size_t found = 0, without = 0;
  double smallest = 1.0;
  for (const bool control : {false, true})
    for (const int threads : {1, 2}) {
      if (control && threads > 1) continue;
      const Spheres s = face_centred(1, 1, 120);
      Scene scene;
      scene.engine.threads = threads;
      scene.engine.options.box_hi = vec(1, 1, 0);
      scene.engine.options.periodic[0] = scene.engine.options.periodic[1] = true;
      scene.grains(s.x, s.r, elastic_material());
      scene.engine.make_bonds(1e-6);
      scene.prepare(Geometry::frozen);
      const double dt = 0.5 * scene.engine.stable_step();
      VecField v(s.x.size(), vec(0, 0, 0));
      for (std::size_t i = 0; i < 4; ++i) v[i] = vec(0, 0, 1e-200);
      v.back() = vec(1e-310, 0, 0);
      scene.engine.motion.velocity = v;
      const unsigned mode = _mm_getcsr();
      if (control) _mm_setcsr(mode & ~0x8040u);  // the same run with denormals allowed has them
      for (int k = 0; k < 100; ++k) {
        scene.step(dt);
        (control ? without : found) += denormals(scene.engine.motion.velocity) + denormals(scene.engine.motion.displacement) +
                                       denormals(scene.engine.motion.force) + denormals(scene.engine.rotation().spin);
      }
      _mm_setcsr(mode);
      for (const Vec u : scene.engine.motion.velocity)
        for (int axis = 0; axis < 3; ++axis)
          if (u[axis] != 0.0) smallest = std::min(smallest, std::fabs(u[axis]));
    }
  CHECK(found == 0);
  CHECK(without > 1000);
  CHECK(smallest < 1e-280);  // the tail ahead of the wave has come down to where its forces are denormal
  figure("denormals_in_grains", static_cast<double>(found));
}
