// Prints particle-steps per second of the engine's two kinds of geometry, per second of wall time and
// of processor time of the stepping thread (the same on a quiet machine).
//   bench_dem [grains = 20000] [threads = 1]

#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <random>

#include "dem_server/engine.hpp"

namespace {

using namespace gabion;
using dem::Vec;
using dem::vec;

struct NoExchange : engine::Exchange {
  void send_gap(std::span<const double>) override {}
  bool receive_multipliers(std::span<double>) override { return true; }
};

/// A cubic array with jittered places; about six neighbours a grain.
void fill(dem::DemEngine& engine, int side, double spacing, double jitter_share, double smallest, double largest) {
  std::mt19937_64 random(1);
  std::uniform_real_distribution<double> jitter(-jitter_share, jitter_share), size(smallest, largest);
  dem::VecField x;
  std::vector<double> r;
  for (int k = 0; k < side; ++k)
    for (int j = 0; j < side; ++j)
      for (int i = 0; i < side; ++i) {
        x.push_back(vec(i + jitter(random), j + jitter(random), k + jitter(random)) * dem::splat(spacing));
        r.push_back(size(random) * spacing);
      }
  const std::vector<std::int32_t> material(x.size(), 0);
  engine.options.box_lo = vec(-0.5, -0.5, -0.5) * dem::splat(spacing);
  engine.options.box_hi = vec(side - 0.5, side - 0.5, side - 0.5) * dem::splat(spacing);
  for (bool& p : engine.options.periodic) p = true;
  engine.set_grains(x, r, material);
}

double processor_time() {
  timespec now{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

void time_steps(dem::DemEngine& engine, const char* name, int threads) {
  engine.threads = threads;
  engine.prepare();
  const double dt = 0.8 * engine.stable_step();
  NoExchange none;
  std::mt19937_64 random(2);
  std::uniform_real_distribution<double> speed(-0.01, 0.01);
  std::vector<double> v(3 * engine.motion.size());
  for (double& c : v) c = speed(random);
  engine.set_field("velocity", v);
  engine::StepContext context;
  context.dt = dt;
  const auto run = [&](int steps) {
    for (int s = 0; s < steps; ++s, context.time += dt) engine.step(context, none);
  };
  run(20);
  const int steps = static_cast<int>(2e6 / static_cast<double>(engine.motion.size())) + 10;
  const double work = static_cast<double>(engine.motion.size()) * steps;
  double best_wall = 0.0, best_processor = 0.0;
  for (int repeat = 0; repeat < 7; ++repeat) {
    const auto start = std::chrono::steady_clock::now();
    const double processor = processor_time();
    run(steps);
    const std::chrono::duration<double> wall = std::chrono::steady_clock::now() - start;
    best_wall = std::max(best_wall, work / wall.count());
    best_processor = std::max(best_processor, work / (processor_time() - processor));
  }
  double contacts = 0.0;
  for (const engine::NamedCount& count : engine.counters())
    if (count.name == "contacts") contacts = 2.0 * count.value / static_cast<double>(engine.motion.size());
  std::printf(
      "%-28s %8zu grains %5.2f contacts/grain %d thread(s): %6.2f M particle-steps/s (%6.2f per processor s)  hash "
      "%016llx\n",
      name, engine.motion.size(), contacts, threads, best_wall * 1e-6, best_processor * 1e-6,
      static_cast<unsigned long long>(engine.state_hash()));
}

}  // namespace

int main(int argc, char** argv) {
  const int grains = argc > 1 ? std::atoi(argv[1]) : 20000;
  const int threads = argc > 2 ? std::atoi(argv[2]) : 1;
  const int side = std::max(4, static_cast<int>(std::cbrt(grains) + 0.5));
  const dem::GrainMaterial soil{3.78e9, 1.13e9, 2650.0, INFINITY, INFINITY, INFINITY};
  const dem::GrainMaterial gravel{1.77e9, 0.35e9, 2650.0, 0.5, 1.78e5, 1.78e5};
  const dem::GrainMaterial loose{1.77e9, 0.35e9, 2650.0, 0.5, 0.0, 0.0};
  constexpr double spacing = 0.2, bond_gap = 0.35;
  struct Case {
    const char* name;
    dem::Geometry geometry;
    const dem::GrainMaterial& material;
    bool bonds;
  };
  for (const Case& c : {Case{"bonded, frozen", dem::Geometry::frozen, soil, true},
                        Case{"bonded, updated", dem::Geometry::updated, soil, true},
                        Case{"breakable bonds, updated", dem::Geometry::updated, gravel, true},
                        Case{"frictional, updated", dem::Geometry::updated, loose, false}}) {
    dem::DemEngine engine;
    if (c.bonds)
      fill(engine, side, spacing, 0.04, 0.33, 0.5);  // size ratio up to 1.5, bonds across gaps
    else
      fill(engine, side, spacing, 0.001, 0.502, 0.508);  // touching
    engine.set_materials({c.material});
    engine.set_contact_options({c.geometry, true, 0.0});
    if (c.bonds) engine.make_bonds(bond_gap);
    time_steps(engine, c.name, threads);
  }
  return 0;
}
