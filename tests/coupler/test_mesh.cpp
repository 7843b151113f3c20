#include <catch2/catch.hpp>
#include <algorithm>
#include <cmath>

#include "coupler/ground/probe_rows.hpp"
#include "coupler/ground/surface.hpp"
#include "tests/coupler/sample.hpp"

using namespace sample;

TEST_CASE("elements fill the ground but the hole", "[mesh]") {
  const Ground g = Ground::make(pit, 3.0, 1.5, false);
  double volume = 0.0;
  for (const auto& cell : g.mesh.cells) volume += g.mesh.grid.cell_volume(cell);
  CHECK(volume == Approx(12.0 * 12 * 24 - 0.0 * 0 * 12).epsilon(1e-12));  // the zone is 6 wide: the overlap leaves no hole
  const Ground edge = Ground::make(pit, 0.0, 1.5, true);
  volume = 0.0;
  for (const auto& cell : edge.mesh.cells) volume += edge.mesh.grid.cell_volume(cell);
  CHECK(volume == Approx(12.0 * 12 * 24 - 6.0 * 6 * 15).epsilon(1e-12));
}

TEST_CASE("grid lines meet the zone's planes", "[mesh]") {
  const Ground g = Ground::make(half, 3.1, 1.4, false);
  const auto& z = g.mesh.grid.lines(2);
  const auto has = [&](double p) {
    for (const double line : z)
      if (std::fabs(line - p) < 1e-12) return true;
    return false;
  };
  CHECK(has(15.0));
  CHECK(has(11.9));
}

TEST_CASE("interface nodes come first", "[mesh]") {
  const Ground g = Ground::make(half, 3.0, 1.5, false);
  bool seen_far = false;
  for (const Point& x : g.mesh.nodes) {
    const bool near = x[2] >= 12.0 - 1e-9 && x[2] <= 15.0 + 1e-9;
    REQUIRE(!(near && seen_far));
    seen_far = seen_far || !near;
  }
}

TEST_CASE("levels follow the layers from the interface, and nodes are numbered by them", "[mesh]") {
  Ground g = Ground::make(pit, 1.5, 1.5, false);
  scene::Rates rates{.largest = 0, .nested = true, .layers = 2, .first_layers = 2, .energy_tolerance = 0.1};
  const coupler::Grid grid = coupler::make_grid(g.scene, g.zone);
  const coupler::HexMesh plain = coupler::make_mesh(grid, g.zone), mesh = coupler::make_mesh(grid, g.zone, rates);
  REQUIRE(plain.level.empty());
  REQUIRE(mesh.level.size() == mesh.elements.size());
  int highest = 0;
  for (std::size_t e = 0; e < mesh.elements.size(); ++e) {
    // the overlap is one element wide and the grid cubic: layers are counted by the distance beyond the zone
    const int layer = std::max(0, static_cast<int>(std::ceil(g.zone.beyond_outer(grid.cell_centre(mesh.cells[e])) / 1.5 - 1e-9)));
    const int expected = layer <= 2 ? 0 : 1 + (layer - 3) / 2;
    CHECK(mesh.level[e] == expected);
    highest = std::max(highest, expected);
  }
  CHECK(highest == 2);
  std::vector<std::pair<int, int>> key(mesh.nodes.size(), {255, 0});
  for (std::size_t e = 0; e < mesh.elements.size(); ++e)
    for (const std::int32_t n : mesh.elements[e])
      key[n] = {std::min<int>(key[n].first, mesh.level[e]), std::max<int>(key[n].second, mesh.level[e])};
  CHECK(std::is_sorted(key.begin(), key.end()));
  // the tied nodes stay the first, as without rates
  const coupler::InterfaceRows rows = g.rows("strict");
  CHECK_FALSE(rows.tied_nodes.empty());
  for (std::size_t n = 0; n < rows.tied_nodes.size(); ++n) CHECK(mesh.nodes[rows.tied_nodes[n]] == plain.nodes[rows.tied_nodes[n]]);

  rates.nested = false;
  const coupler::HexMesh at_once = coupler::make_mesh(grid, g.zone, rates);
  for (std::size_t e = 0; e < mesh.elements.size(); ++e) CHECK(at_once.level[e] == (mesh.level[e] > 0 ? 1 : 0));
}

TEST_CASE("grading grows elements away from the zone", "[mesh]") {
  Ground g;
  g.scene.ground.box = {{0, 0, 0}, {40, 4, 4}};
  g.scene.mesh.size = 1.0;
  g.scene.mesh.grading = 1.3;
  const coupler::Zone zone(g.scene.ground.box, {{0, 0, 0}, {10, 4, 4}}, 2.0, 0.01);
  const coupler::Grid grid = coupler::make_grid(g.scene, zone);
  const auto& x = grid.lines(0);
  double previous = 0.0;
  for (std::size_t i = 1; i < x.size(); ++i)
    if (x[i - 1] >= 10.0 - 1e-9) {
      CHECK(x[i] - x[i - 1] > previous);
      previous = x[i] - x[i - 1];
    }
  CHECK(x.back() == 40.0);
}

TEST_CASE("the areas of a face add up, with weights in the overlap", "[surface]") {
  const bool edge = GENERATE(false, true);
  const Ground g = Ground::make(half, 3.0, 1.5, edge);
  const std::array<bool, 3> periodic{};
  const auto grains = coupler::grain_patch(1, g.scene.ground.box, periodic, g.zone, g.grains);
  const auto nodes = coupler::mesh_patch(1, g.mesh, g.zone);
  CHECK(grains.total() + nodes.total() == Approx(12.0 * 24).epsilon(edge ? 0.03 : 2e-3));
  // moments about the ground's corner: of grains and nodes together, along z
  double moment = 0.0;
  for (std::size_t k = 0; k < grains.area.size(); ++k) moment += grains.area[k] * g.grains.position[grains.entities[k]][2];
  for (std::size_t k = 0; k < nodes.area.size(); ++k) moment += nodes.area[k] * g.mesh.nodes[nodes.entities[k]][2];
  CHECK(moment == Approx(12.0 * 24 * 12).epsilon(edge ? 0.03 : 2e-3));
}

TEST_CASE("probes reproduce affine fields", "[probe]") {
  const Ground g = Ground::make(half, 3.0, 1.5, false);
  const auto affine = [](const Point& x) { return 1.0 + 0.5 * x[0] - 2.0 * x[1] + 0.25 * x[2]; };
  const std::array<bool, 3> periodic{};
  const Point in_grains{6, 6, 0}, in_mesh{6.2, 5.1, 20.7};
  const auto check = [&](const coupler::ProbeRow& row, const std::vector<Point>& points, const Point& at) {
    double value = 0.0;
    for (std::size_t k = 0; k < row.entities.size(); ++k) value += row.coefficients[k] * affine(points[row.entities[k]]);
    CHECK(value == Approx(affine(at)).margin(1e-9));
  };
  check(coupler::probe_in_grains(in_grains, g.grains, g.scene.ground.box, periodic), g.grains.position, in_grains);
  check(coupler::probe_in_mesh(in_mesh, g.mesh, g.zone), g.mesh.nodes, in_mesh);
}

TEST_CASE("a periodic face-centred lattice fits a whole number of cells", "[lattice]") {
  scene::Scene scene;
  scene.ground.box = {{0, 0, 0}, {2, 2, 10}};
  scene.ground.periodic = {true, true, false};
  scene.grains.packing = "fcc";
  scene.grains.radius = {0.35};
  const auto packing = coupler::make_lattice(scene);
  CHECK(packing.radius[0] == Approx(1.0 / (2.0 * std::sqrt(2.0))).epsilon(1e-14));
  CHECK(packing.position.size() == 4 * 2 * 2 * 10 + 2 * 4);  // the last plane, z = 10, has two grains a cell
  CHECK(packing.solid_fraction == Approx(0.74048).epsilon(1e-5));
  scene.ground.box.hi[1] = 2.3;
  CHECK_THROWS_WITH(coupler::make_lattice(scene), Catch::Contains("whole number"));
}
