#include <catch2/catch.hpp>
#include <cmath>

#include "coupler/run/zone_watch.hpp"

using namespace gabion::coupler;

namespace {

/// A bar of grains along z, 1 m apart and 1 m thick, with mesh below z = 0: overlap from 0 to 4 m.
struct Bar {
  GrainSet grains;
  Zone zone{{{-5, -5, -10}, {5, 5, 20}}, {{-5, -5, 0}, {5, 5, 20}}, 4.0, 0.01};
  InterfaceRows rows;

  Bar() {
    for (int z = 0; z < 20; ++z) {
      grains.position.push_back({0.0, 0.0, z + 0.5});
      grains.radius.push_back(0.5);
      grains.plain_mass.push_back(1.0);
    }
  }

  /// Every grain has 100 contacts; damaged of grain k are share(k) of them.
  template <typename Share>
  std::vector<double> yield(Share share) const {
    std::vector<double> rows_of_yield;
    for (std::size_t k = 0; k < grains.position.size(); ++k)
      for (const double value : {100.0, 100.0 * share(k), 0.0}) rows_of_yield.push_back(value);
    return rows_of_yield;
  }
};

}  // namespace

TEST_CASE("a zone whose overlap stays whole is large enough") {
  const Bar bar;
  ZoneWatch watch(bar.zone, bar.grains, &bar.rows);
  CHECK(watch.verdict(1.0).is_null());  // nothing looked at yet
  watch.look(bar.yield([](std::size_t k) { return k >= 4 ? 0.9 : 0.0; }), {});
  const auto verdict = watch.verdict(1.0);
  CHECK(verdict["large_enough"] == true);
  CHECK(verdict["damaged_share"] == 0.0);
  CHECK(watch.advice(1.0, 0.0).empty());
  CHECK(watch.damage()[10] == Approx(0.9));
}

TEST_CASE("damage in the overlap says which face to move and by how much") {
  const Bar bar;
  ZoneWatch watch(bar.zone, bar.grains, &bar.rows);
  watch.look(bar.yield([](std::size_t k) { return k >= 2 ? 0.3 : 0.0; }), {});
  watch.look(bar.yield([](std::size_t) { return 0.0; }), {});  // the largest of all looks counts
  const auto verdict = watch.verdict(1.0);
  CHECK(verdict["large_enough"] == false);
  CHECK(verdict["damaged_share"].get<double>() == Approx(0.3));
  CHECK(verdict["missed_share"].get<double>() == Approx((0.3 - std::sqrt(60.0) / 100.0) * (1.0 - 2.5 / 4.0)));  // less the standard error of 30 contacts, each in two grains
  REQUIRE(verdict["too_small_by"].size() == 1);
  CHECK(verdict["too_small_by"]["zmin"].get<double>() == Approx(2.0));  // shells 2 and 3 of four
  REQUIRE(watch.advice(1.0, 0.0).size() == 1);
  CHECK(watch.advice(1.0, 0.0)[0].find("zmin face out by about 2 m") != std::string::npos);
  REQUIRE(watch.advice(1.0, 0.2).size() == 2);
  CHECK(watch.advice(1.0, 0.2)[0].find("cannot follow") != std::string::npos);
}

TEST_CASE("damage up to the outer face means more than the whole overlap") {
  const Bar bar;
  ZoneWatch watch(bar.zone, bar.grains, &bar.rows);
  watch.look(bar.yield([](std::size_t) { return 0.5; }), {});
  REQUIRE(watch.advice(1.0, 0.0).size() == 1);
  CHECK(watch.advice(1.0, 0.0)[0].find("zmin face out by more than 4 m") != std::string::npos);
}

TEST_CASE("a little damage where the mesh carries almost nothing is reported, not flagged") {
  const Bar bar;
  ZoneWatch watch(bar.zone, bar.grains, &bar.rows);
  watch.look(bar.yield([](std::size_t k) { return k >= 3 ? 0.05 : 0.0; }), {});
  const auto verdict = watch.verdict(1.0);
  CHECK(verdict["damaged_share"].get<double>() == Approx(0.05));
  CHECK(verdict["large_enough"] == true);
  // the share is told, and does not contradict the verdict
  REQUIRE(watch.advice(1.0, 0.02).size() == 1);
  CHECK(watch.advice(1.0, 0.02)[0].find("2 % of the contacts of tied grains") == 0);
  CHECK(watch.advice(1.0, 0.02)[0].find("large enough") != std::string::npos);
}

TEST_CASE("single contacts of a shell of few grains decide nothing") {
  const Bar bar;
  ZoneWatch watch(bar.zone, bar.grains, &bar.rows);
  watch.look(bar.yield([](std::size_t) { return 0.02; }), {});
  CHECK(watch.verdict(1.0)["damaged_share"].get<double>() == Approx(0.02));
  CHECK(watch.large_enough());
  watch.look(bar.yield([](std::size_t) { return 0.08; }), {});
  CHECK_FALSE(watch.large_enough());
}

TEST_CASE("motion within an element is unresolved, motion of all is not") {
  Bar bar;
  for (std::int32_t g = 0; g < 4; ++g) {  // one hat for the four grains of the overlap
    bar.rows.hat_grains.push_back(g);
    bar.rows.share.push_back(1.0);
    bar.rows.hats.push(0, 1.0);
    bar.rows.hats.end_row();
  }
  const auto looked = [&](double other) {
    ZoneWatch watch(bar.zone, bar.grains, &bar.rows);
    std::vector<double> velocity(3 * bar.grains.position.size(), 0.0);
    for (std::size_t g = 0; g < 4; ++g) velocity[3 * g + 2] = g % 2 == 0 ? 1.0 : other;
    watch.look(bar.yield([](std::size_t) { return 0.0; }), velocity);
    return watch.verdict(20.0);
  };
  CHECK(looked(1.0)["unresolved_energy"] == 0.0);
  const auto apart = looked(-1.0);
  CHECK(apart["unresolved_energy"].get<double>() == Approx(2.0 / 20.0));  // four grains of 1/2 J
  CHECK(apart["mesh_fine_enough"] == false);
}

TEST_CASE("what a watch has seen outlives a checkpoint") {
  const Bar bar;
  ZoneWatch watch(bar.zone, bar.grains, &bar.rows);
  watch.look(bar.yield([](std::size_t k) { return k >= 1 ? 0.37 : 0.0; }), {});
  ZoneWatch again(bar.zone, bar.grains, &bar.rows);
  again.remember(watch.memory());
  CHECK(again.verdict(1.0) == watch.verdict(1.0));
  CHECK(again.damage() == watch.damage());
}
