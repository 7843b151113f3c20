// The tied step is as stable as the worse of its two sides, whatever the overlap, the weights and the two media are.

#include <catch2/catch.hpp>

#include "coupled.hpp"
#include "tests/figure.hpp"

using namespace gabion;
using namespace gabion::coupled;

namespace {

/// Range of the energy balance over a run of random motion, over the energy.
double drift(Coupled& all, double fraction, int steps) {
  const double dt = fraction * all.stable_step();
  all.shake(1e-3);
  all.step(dt);
  const double first = all.balance();
  double largest = 0.0;
  for (int part = 0; part < 20; ++part) {
    all.step(dt, steps / 20);
    largest = std::max(largest, std::fabs(all.balance() - first));
  }
  REQUIRE(std::isfinite(all.largest_speed()));
  REQUIRE(first > 0.0);
  return largest / first;
}

double stable(const Column& c) {
  return stable_fraction([&] { return std::make_unique<Coupled>(c); }, 2e-3, 2000);
}

/// What many columns have in common: each keeps its energy at 0.98 of the limit, stays bounded next to it, and tied.
struct Extremes {
  double drift = 0.0, gap = 0.0;

  void add(const Column& c, int steps) {
    Coupled all(c);
    CHECK(all.multipliers->report().rank <= all.multipliers->report().rows);
    drift = std::max(drift, ::drift(all, 0.98, steps));
    gap = std::max(gap, all.velocity_gap() / all.largest_speed());
    Coupled again(c);
    CHECK(stays_bounded(again, 0.998 * again.stable_step(), steps + 1000));
  }
  void check(const std::string& name) const {
    CHECK(drift < 1e-10);
    CHECK(gap < 1e-9);
    figure((name + "_drift").c_str(), drift);
    figure((name + "_gap").c_str(), gap);
  }
};

}  // namespace

TEST_CASE("a tied step is stable up to the uncoupled limit and no further") {
  double least = 10.0, worst = 0.0;
  for (const char* rows : {"mortar", "mortar2h", "strict", "edge", "edge_projected", "edge_hats"}) {
    CAPTURE(rows);
    Column c;
    c.rows = rows;
    c.width = 0.4;
    if (c.rows.starts_with("edge")) c.model = "edge";
    const double found = stable(c);
    least = std::min(least, found);
    CHECK(found < 1.5);  // beyond it the motion grows: the bisection has seen both
    Coupled all(c);
    worst = std::max(worst, drift(all, 0.98, 4000));
  }
  CHECK(least >= 0.998);
  CHECK(worst < 1e-11);
  figure("coupled_limit_over_uncoupled", least);
  figure("coupled_drift_at_098", worst);
}

TEST_CASE("weights near zero cost no step") {
  double least = 10.0, worst = 0.0;
  for (const char* rows : {"mortar", "strict"})
    for (const double floor : {0.1, 0.01, 1e-3, 1e-4, 1e-6}) {
      CAPTURE(rows, floor);
      Column c;
      c.rows = rows;
      c.width = 0.4;
      c.floor = floor;
      least = std::min(least, stable(c));
      Coupled all(c);
      worst = std::max(worst, drift(all, 0.98, 4000));
    }
  CHECK(least >= 0.998);
  CHECK(worst < 1e-11);
  figure("floor_limit_over_uncoupled", least);
  figure("floor_drift", worst);
}

TEST_CASE("media of very different stiffness and density stay tied and keep their energy") {
  Extremes extremes;
  for (const char* rows : {"mortar", "strict", "edge"})
    for (const double stiffness : {1e-6, 1e-3, 1e3, 1e6})
      for (const double density : {1e-3, 1.0, 1e3}) {
        CAPTURE(rows, stiffness, density);
        Column c;
        c.rows = rows;
        if (c.rows == "edge") c.model = "edge";
        c.width = 0.4;
        c.stiffness = stiffness;
        c.density = density;
        extremes.add(c, 2000);
      }
  extremes.check("contrast");
}

TEST_CASE("overlaps from half an element, elements from one grain to twenty") {
  Extremes extremes;
  const double d = 0.14142135623730951;
  for (const char* rows : {"mortar", "strict"})
    for (const double size : {1.0, 1.5, 2.5, 5.0, 10.0, 20.0})
      for (const double wide : {0.5, 1.0, 2.0, 8.0}) {
        CAPTURE(rows, size, wide);
        Column c;
        c.rows = rows;
        c.width = 0.2;
        c.element = size * d;
        c.overlap = wide * c.element;
        c.grains_alone = 0.6;
        c.mesh_alone = 2 * c.element;
        if (c.overlap < 0.5 * d) continue;  // no grain's centre in it
        extremes.add(c, 1000);
      }
  extremes.check("sizes");
}

TEST_CASE("a zone with five faces, edges and corners keeps its energy and momentum") {
  double worst = 0.0, momentum = 0.0;
  for (const char* rows : {"mortar", "strict", "edge"}) {
    CAPTURE(rows);
    scene::Scene s = scene_of({.model = std::string(rows) == "edge" ? "edge" : "bridging", .rows = rows, .lattice = "sc", .radius = 0.1});
    s.ground.box = {{0, 0, 0}, {4.0, 4.0, 2.0}};
    s.ground.periodic = {false, false, false};
    s.grains.zone = scene::Box{{0.8, 0.8, 0.8}, {3.2, 3.2, 2.0}};
    s.mesh.size = 0.4;
    s.coupling.overlap = 0.8;
    Coupled all(s);
    CHECK(all.multipliers->report().rank == all.multipliers->report().rows);
    worst = std::max(worst, drift(all, 0.98, 400));
    const Vec before = all.momentum();
    all.step(0.9 * all.stable_step(), 200);
    const Vec after = all.momentum();
    const double scale = all.dem.momentum()[6] + all.solid.momentum()[6];
    momentum = std::max(momentum, engine::norm(after - before) / scale);
  }
  CHECK(worst < 1e-11);
  CHECK(momentum < 1e-12);
  figure("corner_drift", worst);
  figure("corner_momentum", momentum);
}

TEST_CASE("more multipliers than the grains can carry: elements as small as grains") {
  double worst = 0.0, gap = 0.0, least_rank = 1.0, condition = 0.0;
  for (const char* rows : {"mortar", "strict"})
    for (const char* lattice : {"fcc", "sc"})
      for (const double size : {0.5, 1.0}) {
        CAPTURE(rows, lattice, size);
        Column c;
        c.rows = rows;
        c.lattice = lattice;
        if (c.lattice == "sc") c.radius = 0.1;
        c.element = size * 2 * c.radius;
        c.overlap = 0.8;
        c.grains_alone = 0.4;
        c.mesh_alone = 0.4;
        Coupled all(c);
        const auto& report = all.multipliers->report();
        least_rank = std::min(least_rank, static_cast<double>(report.rank) / static_cast<double>(report.rows));
        condition = std::max(condition, report.condition);
        worst = std::max(worst, drift(all, 0.95, 1000));
        gap = std::max(gap, all.velocity_gap() / all.largest_speed());
      }
  CHECK(worst < 1e-10);
  CHECK(gap < 1e-9);
  figure("rank_over_rows", least_rank);
  figure("small_elements_condition", condition);
  figure("small_elements_drift", worst);
  figure("small_elements_gap", gap);
}
