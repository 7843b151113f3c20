// Element-steps per second of the whole step, one line a case:  bench_continuum [elements per edge] [steps] [threads]

#include <chrono>
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

}  // namespace

int main(int argc, char** argv) {
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
