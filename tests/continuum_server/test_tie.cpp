// The engine's step with an interface: two bars tied by rows are one bar.

#include <catch2/catch.hpp>

#include "solid_fixture.hpp"

using namespace gabion::continuum;
namespace engine = gabion::engine;
using engine::norm;
using engine::vec;

namespace {

constexpr int layers = 6, tied_pairs = 4;
const SolidMaterial soil = isotropic(1e6, 0.3, 1000.0);

/// The upper half of a bar with its lowest nodes numbered 0 to 3, and the lower half, numbered from its top
/// downwards, its highest nodes 4 to 7; then everything else.
struct Halves {
  Mesh mesh;
  std::vector<int> whole;  ///< node of the unbroken bar that each node stands for

  Halves() {
    const Mesh bar = box_mesh({1, 1, 2 * layers}, vec(1, 1, 2 * layers));
    const auto take = [&](int node) {
      mesh.nodes.push_back(bar.nodes[node]);
      whole.push_back(node);
    };
    const int middle = 4 * layers;
    for (int k = 0; k < 4; ++k) take(middle + k);
    for (int k = 0; k < 4; ++k) take(middle + k);
    std::vector<int> lower(bar.nodes.size(), -1), upper = lower;
    for (int k = 0; k < 4; ++k) upper[middle + k] = k, lower[middle + k] = 4 + k;
    for (int layer = 1; layer <= layers; ++layer)
      for (int k = 0; k < 4; ++k) {
        upper[middle + 4 * layer + k] = static_cast<int>(mesh.nodes.size());
        take(middle + 4 * layer + k);
        lower[middle - 4 * layer + k] = static_cast<int>(mesh.nodes.size());
        take(middle - 4 * layer + k);
      }
    for (int e = 0; e < 2 * layers; ++e) {
      auto& nodes = mesh.elements.emplace_back();
      for (int c = 0; c < 8; ++c) nodes[c] = (e < layers ? lower : upper)[bar.elements[e][c]];
      mesh.material.push_back(0);
    }
  }
};

/// The coupler's part: A mu = g, with one row a pair of nodes, A = 1/m + 1/m.
struct Pairs : engine::Exchange {
  std::vector<double> gap, inverse;
  void send_gap(std::span<const double> rows) override { gap.assign(rows.begin(), rows.end()); }
  bool receive_multipliers(std::span<double> rows) override {
    for (std::size_t r = 0; r < rows.size(); ++r) rows[r] = gap[r] * inverse[r / 3];
    return true;
  }
};

}  // namespace

TEST_CASE("two bars tied by rows move as one, and the multipliers do no net work") {
  const Halves halves;
  Solid one(box_mesh({1, 1, 2 * layers}, vec(1, 1, 2 * layers)), soil), two(halves.mesh, soil);
  two.engine.threads = GENERATE(1, 2);
  Pairs pairs;
  std::vector<std::int32_t> row_ptr{0}, columns;
  std::vector<double> values;
  for (Solid* solid : {&one, &two}) solid->engine.prepare();
  for (int k = 0; k < tied_pairs; ++k) {
    columns.insert(columns.end(), {k, 4 + k});
    values.insert(values.end(), {-1.0, 1.0});
    row_ptr.push_back(2 * (k + 1));
    pairs.inverse.push_back(1.0 / (1.0 / two.engine.motion.mass[k] + 1.0 / two.engine.motion.mass[4 + k]));
  }
  two.engine.tie.set(engine::Tie::Mode::gap, tied_pairs, {}, row_ptr, columns, values, two.engine.motion);
  REQUIRE(two.engine.tie.reach() == 8);
  one.set_noise(one.engine.motion.velocity, 1e-2);
  for (std::size_t n = 0; n < halves.whole.size(); ++n)
    two.engine.motion.velocity[n] = one.engine.motion.velocity[halves.whole[n]];

  const double dt = 0.9 * one.engine.stable_step();
  double energy = 0.0, imbalance = 0.0;
  for (int step = 0; step < 500; ++step) {
    one.run(1, dt);
    two.engine.step({step * dt, dt, 0.0, true}, pairs);
    const double balance = two.engine.ledger().balance();
    if (step == 0) energy = balance;
    imbalance = std::max(imbalance, std::fabs(balance - energy));
  }
  CHECK(imbalance < 1e-12 * energy);
  double error = 0.0, scale = 0.0;
  for (std::size_t n = 0; n < halves.whole.size(); ++n) {
    const Vec u = one.engine.motion.displacement[halves.whole[n]];
    error = std::max(error, norm(two.engine.motion.displacement[n] - u));
    scale = std::max(scale, norm(u));
  }
  CHECK(error < 1e-12 * scale);
  CHECK(norm(two.engine.motion.tie_force[0]) > 0.0);
  const auto ledger = two.engine.ledger();
  for (const auto& entry : ledger.entries)
    if (entry.name == "multipliers") CHECK(std::fabs(entry.energy) < 1e-12 * energy);
}
