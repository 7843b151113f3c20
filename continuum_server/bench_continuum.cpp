// Element-steps per second of the whole step, one line a case:  bench_continuum [elements per edge] [steps] [threads]
// One rate against rates 1 to 8 around a corner, one JSON object:  bench_continuum rates [elements per edge] [steps] [threads]

#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <string>

#include "continuum_server/box_mesh.hpp"
#include "continuum_server/continuum_engine.hpp"

using namespace gabion::continuum;
namespace engine = gabion::engine;

namespace {

struct NoExchange : engine::Exchange {
  void send_gap(std::span<const double>) override {}
  bool receive_multipliers(std::span<double>) override { return true; }
};

void time_case(const char* name, const SolidMaterial& material, double distortion, int edge, int steps, int threads) {
  ContinuumEngine solid;
  solid.threads = threads;
  Mesh mesh = box_mesh({edge, edge, edge}, engine::vec(edge, edge, edge));
  if (distortion > 0.0) distort(mesh, distortion);
  solid.set_mesh(std::move(mesh));
  solid.set_materials({material});
  solid.prepare();
  const double dt = 0.5 * solid.stable_step();
  for (std::size_t n = 0; n < solid.motion.size(); ++n) solid.motion.velocity[n] = 1e-6 * solid.motion.position[n];
  NoExchange nobody;
  const auto run = [&](int count) {
    for (int k = 0; k < count; ++k) solid.step({k * dt, dt, 0.0, false}, nobody);
  };
  run(steps / 5 + 1);
  double best = 1e300;
  for (int repeat = 0; repeat < 3; ++repeat) {
    const auto start = std::chrono::steady_clock::now();
    run(steps);
    const std::chrono::duration<double> spent = std::chrono::steady_clock::now() - start;
    best = std::min(best, spent.count());
  }
  const double elements = static_cast<double>(edge) * edge * edge;
  std::printf("%-24s %9.0f elements  %d threads  %7.2f M element-steps/s  hash %016llx\n", name, elements, threads,
              1e-6 * elements * steps / best, static_cast<unsigned long long>(solid.state_hash()));
}

/// Rates as scenarios/two_rates.json has them: 1 in the corner's 3 elements and 2 layers more, then 6 layers each of 2 and 4.
std::vector<std::uint8_t> corner_rates(int edge) {
  constexpr int corner = 3, first_layers = 2, layers = 6, largest = 8;
  std::vector<std::uint8_t> rate;
  for (int k = 0; k < edge; ++k)
    for (int j = 0; j < edge; ++j)
      for (int i = 0; i < edge; ++i) {
        const int beyond = std::max({i, j, k}) - (corner - 1) - first_layers;
        rate.push_back(static_cast<std::uint8_t>(beyond <= 0 ? 1 : std::min(largest, 2 << std::min(10, (beyond - 1) / layers))));
      }
  return rate;
}

void time_rates(int edge, int steps, int threads) {
  const SolidMaterial soil = isotropic(5e8, 0.32, 1700.0);
  const std::vector<std::uint8_t> rate = corner_rates(edge);
  double evaluated = 0.0, best[2] = {1e300, 1e300};
  for (const std::uint8_t r : rate) evaluated += 1.0 / r;
  NoExchange nobody;
  ContinuumEngine solids[2];
  double dt = 0.0;
  for (const bool several : {false, true}) {
    ContinuumEngine& solid = solids[several];
    solid.threads = threads;
    Mesh mesh = box_mesh({edge, edge, edge}, engine::vec(edge, edge, edge));
    if (several) number_by_rates(mesh, rate);
    solid.set_mesh(std::move(mesh));
    solid.set_materials({soil});
    solid.prepare();
    if (several) solid.set_rates(rate);
    dt = 0.5 * solid.stable_step();
    for (std::size_t n = 0; n < solid.motion.size(); ++n)
      for (int axis = 0; axis < 3; ++axis) solid.motion.velocity[n][axis] = 1e-6 * std::sin(solid.motion.position[n][axis]);
  }
  const int whole = (steps + 7) / 8 * 8;
  int step[2] = {0, 0};
  for (int repeat = 0; repeat < 4; ++repeat)  // the first one warms up
    for (const bool several : {false, true}) {
      const auto start = std::chrono::steady_clock::now();
      for (int k = 0; k < whole; ++k, ++step[several])
        solids[several].step({step[several] * dt, dt, 0.0, false, static_cast<std::uint64_t>(step[several])}, nobody);
      const std::chrono::duration<double> spent = std::chrono::steady_clock::now() - start;
      if (repeat > 0) best[several] = std::min(best[several], spent.count() / whole);
    }
  const double elements = static_cast<double>(rate.size());
  std::printf("{\"elements\": %.0f, \"threads\": %d, \"one_rate_us\": %.3f, \"rates_us\": %.3f, \"wall_speedup\": %.4f, \"counts_speedup\": %.4f}\n",
              elements, threads, 1e6 * best[0], 1e6 * best[1], best[0] / best[1], elements / evaluated);
}

}  // namespace

int main(int argc, char** argv) {
  if (argc > 1 && std::string(argv[1]) == "rates") {
    time_rates(argc > 2 ? std::atoi(argv[2]) : 48, argc > 3 ? std::atoi(argv[3]) : 80, argc > 4 ? std::atoi(argv[4]) : 1);
    return 0;
  }
  const int edge = argc > 1 ? std::atoi(argv[1]) : 37;
  const int steps = argc > 2 ? std::atoi(argv[2]) : 100;
  const int threads = argc > 3 ? std::atoi(argv[3]) : 1;
  const SolidMaterial soil = isotropic(5e8, 0.32, 1700.0);
  SolidMaterial full = soil;
  constexpr double coupling = 0.02;  // share of the largest entry put everywhere
  for (int r = 0; r < 6; ++r)
    for (int s = 0; s < 6; ++s) full.stiffness[6 * r + s] += coupling * soil.stiffness[0] * (r == s ? 2.0 : 1.0);
  time_case("bricks, isotropic", soil, 0.0, edge, steps, threads);
  time_case("bricks, full 6x6", full, 0.0, edge, steps, threads);
  time_case("distorted", soil, 0.1, edge, steps, threads);
}
