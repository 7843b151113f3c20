// The stable step of coupled columns over the smaller of the two media's own, by bisection with random motion and frozen
// contacts; one JSON object a line. bench_stability [--quick]

#include <cstdio>
#include <cstring>

#include "dem_server/packing/packing.hpp"
#include "tests/coupled/coupled.hpp"

using namespace gabion::coupled;

namespace {

constexpr double diameter = 0.1414213562373095;
constexpr double resolution = 2e-3;

/// One line; damping and seed as the map has them.
void print(const char* map, const Column& c, double elements, double size, double damping, std::uint64_t seed,
           const std::function<std::unique_ptr<Coupled>()>& make) {
  const double found = stable_fraction(make, resolution, 2000, damping);
  const auto& report = make()->multipliers->report();
  std::printf("{\"map\": \"%s\", \"rows\": \"%s\", \"overlap\": %g, \"size\": %g, \"stiffness\": %g, \"floor\": %g, \"damping\": %g, "
              "\"seed\": %d, \"fraction\": %.4f, \"tied_rows\": %zu, \"rank\": %zu, \"condition\": %.4g}\n",
              map, c.rows.c_str(), elements, size, c.stiffness, c.floor, damping, static_cast<int>(seed), found, report.rows, report.rank,
              report.condition);
  std::fflush(stdout);
}

void print(const char* map, const Column& c, double elements, double size, double damping = 0.0) {
  print(map, c, elements, size, damping, 0, [&] { return std::make_unique<Coupled>(c); });
}

/// A random packing of about 500 grains, contact stiffnesses of the lattice, and a mesh of about their stiffness.
void print_random(const char* rows, bool border_weights, double floor, std::uint64_t seed) {
  Column c;
  c.rows = rows;
  c.floor = floor;
  if (c.rows.starts_with("edge")) c.model = "edge";
  gabion::scene::Scene s = scene_of(c);
  s.ground.box.hi[2] = 2.4;
  s.grains.packing = "random";
  s.grains.radius = {0.05, 0.1};
  s.coupling.border_weights = border_weights;
  gabion::dem::PackingRequest request;
  for (int a = 0; a < 3; ++a) {
    request.box.hi[a] = s.ground.box.hi[a];
    request.box.periodic[a] = a != 2;
  }
  request.radius = s.grains.radius;
  request.seed = seed;
  const gabion::dem::Packing made = gabion::dem::make_packing(request);
  gabion::coupler::Packing packing;
  for (const Vec x : made.position) packing.position.push_back({x[0], x[1], x[2]});
  packing.radius = made.radius;
  packing.gap = made.gap;
  gabion::coupler::Elasticity elasticity;
  elasticity.stiffness = gabion::coupler::isotropic_stiffness(500e6, 0.25);
  elasticity.density = 0.63 * s.materials[0].density;
  if (border_weights) c.rows += " with border weights";
  print("random", c, 2.0, 0.4 / 0.15, 0.0, seed, [&] { return std::make_unique<Coupled>(s, packing, elasticity); });
}

Column column(const char* rows) {
  Column c;
  c.rows = rows;
  if (c.rows.starts_with("edge")) c.model = "edge";
  c.width = 0.2;
  c.element = 0.4;
  return c;
}

}  // namespace

int main(int count, char** words) {
  const bool quick = count > 1 && std::strcmp(words[1], "--quick") == 0;
  using List = std::vector<double>;
  const List sizes = quick ? List{1.0, 2.5, 20.0} : List{1.0, 1.5, 2.5, 5.0, 10.0, 20.0};
  const List overlaps = quick ? List{1.0, 4.0} : List{0.5, 1.0, 2.0, 4.0, 8.0};
  const List ratios = quick ? List{1e-3, 1e3} : List{1e-6, 1e-4, 1e-2, 0.1, 1.0, 10.0, 1e2, 1e4, 1e6};
  const List floors = quick ? List{1e-3} : List{0.1, 1e-2, 1e-3, 1e-4, 1e-6};
  for (const char* rows : {"mortar", "mortar2h", "strict"})
    for (const double size : sizes)
      for (const double overlap : overlaps) {
        Column c = column(rows);
        c.element = size * diameter;
        c.overlap = overlap * c.element;
        c.grains_alone = 0.6;
        c.mesh_alone = 2 * c.element;
        if (c.overlap >= 0.5 * diameter) print("overlap", c, overlap, size);
      }
  for (const char* rows : {"edge", "edge_projected", "edge_hats"})
    for (const double size : sizes) {
      Column c = column(rows);
      c.element = size * diameter;
      c.overlap = 0.8;
      c.mesh_alone = 2 * c.element;
      print("edge", c, 0.0, size);
    }
  for (const char* rows : {"mortar", "strict"})
    for (const double stiffness : ratios)
      for (const double floor : floors) {
        Column c = column(rows);
        c.stiffness = stiffness;
        c.floor = floor;
        print("contrast", c, 2.0, c.element / diameter);
      }
  for (const char* rows : {"mortar", "strict", "edge"})
    for (const double damping : quick ? List{0.7} : List{0.1, 0.2, 0.4, 0.7, 0.9}) print("damping", column(rows), 2.0, 2.83, damping);
  for (const std::uint64_t seed : {1, 2, 3}) {
    if (quick && seed > 1) break;
    for (const double floor : {1e-2, 1e-4})
      for (const char* rows : {"mortar", "mortar2h", "strict"}) print_random(rows, false, floor, seed);
    for (const char* rows : {"edge", "edge_projected", "edge_hats"}) print_random(rows, false, 1e-2, seed);
    for (const char* rows : {"edge", "edge_projected"}) print_random(rows, true, 1e-2, seed);
  }
}
