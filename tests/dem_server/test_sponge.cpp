// The sponge: what the hats carry passes, the rest is damped, and its energy is booked.

#include "fixture.hpp"

using namespace gabion::dem;
using namespace gabion::dem::testing;

namespace {

/// A bonded column along z with hats of size 4 on its upper half.
struct Column : Scene {
  int high = 16;
  std::vector<std::int32_t> grains, row_ptr{0}, columns;
  std::vector<double> beta, values;
  std::size_t hats = 3;

  Column() {
    const Spheres s = face_centred(1, 1, high);
    periodic_box(vec(0, 0, 0), vec(1, 1, 4 * high));
    Scene::grains(s.x, s.r, elastic_material());
    engine.options.periodic[2] = false;
    engine.make_bonds(1e-6);
    engine.weights.outer_hi[2] = high;
    engine.weights.width = 8;
    engine.weights.floor = 0.01;
    prepare(Geometry::frozen);
    for (std::size_t i = 0; i < s.x.size(); ++i) {
      const double z = s.x[i][2] - (high - 8);
      if (z < 0) continue;
      grains.push_back(static_cast<std::int32_t>(i));
      beta.push_back(0.3 * z / 8);
      const int cell = std::min(1, static_cast<int>(z / 4));
      const double t = z / 4 - cell;
      columns.insert(columns.end(), {cell, cell + 1});
      values.insert(values.end(), {1 - t, t});
      row_ptr.push_back(static_cast<std::int32_t>(columns.size()));
    }
    engine.set_sponge(grains, beta, hats, row_ptr, columns, values);
  }
};

}  // namespace

TEST_CASE("the sponge leaves linear fields alone and damps the rest") {
  Column c;
  const double dt = 0.5 * c.engine.stable_step();
  VecField v(c.engine.motion.size());
  for (std::size_t i = 0; i < v.size(); ++i) v[i] = vec(1, 2, 3) * splat(0.1 + 0.01 * c.engine.motion.position[i][2]);
  c.set("velocity", v);
  c.step(dt);
  CHECK(std::fabs(c.energy("sponge")) < 1e-9 * c.energy("kinetic"));

  Column d;
  d.set("velocity", random_field(v.size(), 0.1, 4));
  d.step(dt);
  const double before = d.engine.ledger().balance();
  const std::vector<double> momentum = d.engine.momentum();
  double last = 0.0;
  for (int k = 0; k < 40; ++k) {
    d.step(dt, 10);
    CHECK(d.energy("sponge") > last);
    last = d.energy("sponge");
    CHECK(d.engine.ledger().balance() == Approx(before).epsilon(1e-12));
  }
  CHECK(last > 0.1 * before);
  const std::vector<double> after = d.engine.momentum();
  for (int k = 0; k < 3; ++k) CHECK(after[k] == Approx(momentum[k]).margin(1e-8 * momentum[6]));
}

TEST_CASE("a sponge step takes sum of m beta (1 - beta/2) e^2") {
  Column c;
  // no forces: the packing at rest, random velocities, one tiny step
  const VecField v = random_field(c.engine.motion.size(), 0.1, 4);
  c.set("velocity", v);
  const auto kinetic = [&] {
    double twice = 0.0;
    for (std::size_t i = 0; i < v.size(); ++i)
      twice += c.engine.motion.mass[i] * dot(c.engine.motion.velocity[i], c.engine.motion.velocity[i]);
    return 0.5 * twice;
  };
  const double before = kinetic();
  c.step(1e-12);
  double expected = 0.0;
  for (std::size_t p = 0; p < c.grains.size(); ++p) {
    const double b = c.beta[p];
    if (b == 0.0) continue;
    const Vec e = (v[c.grains[p]] - c.engine.motion.velocity[c.grains[p]]) / splat(b);
    expected += c.engine.motion.mass[c.grains[p]] * b * (1 - b / 2) * dot(e, e);
  }
  CHECK(before - kinetic() == Approx(expected).epsilon(1e-6));
}

TEST_CASE("a sponge that does not fit is refused") {
  Column c;
  c.columns[0] = 7;
  CHECK_THROWS_WITH(c.engine.set_sponge(c.grains, c.beta, c.hats, c.row_ptr, c.columns, c.values),
                    Catch::Contains("hat 7"));
  c.beta[0] = 1.5;
  c.columns[0] = 0;
  CHECK_THROWS_WITH(c.engine.set_sponge(c.grains, c.beta, c.hats, c.row_ptr, c.columns, c.values),
                    Catch::Contains("beta"));
}
