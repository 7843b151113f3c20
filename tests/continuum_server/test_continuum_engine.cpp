#include <catch2/catch.hpp>

#include "continuum_server/continuum_engine.hpp"
#include "solid_fixture.hpp"

using namespace gabion::continuum;
namespace engine = gabion::engine;
using engine::PhysicsError;
using engine::RequestError;
using engine::vec;

namespace {

const SolidMaterial soil = isotropic(1e6, 0.3, 1000.0);

/// Bricks on one side, distorted elements on the other.
Mesh mixed_mesh() {
  Mesh mesh = box_mesh({6, 4, 4}, vec(6, 4, 4));
  Mesh moved = mesh;
  distort(moved, 0.15);
  for (std::size_t n = 0; n < mesh.nodes.size(); ++n)
    if (mesh.nodes[n][0] > 3.5) mesh.nodes[n] = moved.nodes[n];
  return mesh;
}

template <class Error, class Action>
Error caught(Action action) {
  try {
    action();
  } catch (const Error& error) {
    return error;
  }
  FAIL("nothing was thrown");
  throw;
}

double entry(const engine::Ledger& ledger, const std::string& name) {
  for (const auto& e : ledger.entries)
    if (e.name == name) return e.energy;
  FAIL("no entry " + name);
  return 0.0;
}

}  // namespace

TEST_CASE("an isolated block keeps its energy over ten thousand steps") {
  Solid solid(mixed_mesh(), soil);
  solid.engine.prepare();
  CHECK(solid.engine.counters()[3].value > 0);
  solid.set_noise(solid.engine.motion.velocity, 1e-2);
  const double dt = 0.9 * solid.engine.stable_step();
  solid.run(1, dt);
  const double energy = solid.engine.ledger().balance();
  for (int part = 0; part < 10; ++part) {
    solid.run(1000, dt);
    CHECK(std::fabs(solid.engine.ledger().balance() - energy) < 1e-12 * energy);
    CHECK(entry(solid.engine.ledger(), "elastic") > 0.01 * energy);
  }
}

TEST_CASE("the ledger balances with gravity, damping, dashpots, loads and a driven face") {
  Solid solid(box_mesh({3, 3, 5}, vec(3, 3, 5)), soil);
  auto& boundary = solid.engine.boundary;
  const std::size_t count = solid.engine.motion.size();
  solid.engine.options.gravity = vec(0, 0, -9.81);
  const auto base = solid.nodes([](Vec x) { return x[2] == 0.0; });
  const auto head = solid.nodes([](Vec x) { return x[2] == 5.0; });
  const auto side = solid.nodes([](Vec x) { return x[0] == 0.0 && x[2] == 2.0; });
  boundary.add(engine::Constraint{"base", base, 7, vec(0, 0, 1), {"half_sine", {0.2, 0.0, 0.3}}}, count);
  boundary.add(engine::Load{"head", head, VecField(head.size(), vec(10, 0, -100)), {"ramp", {1.0, 0.0, 0.2}}}, count);
  boundary.add(engine::Dashpot{"side", side, VecField(side.size(), vec(1e3, 1e3, 1e3))}, count);
  solid.engine.prepare();
  const double dt = 0.6 * solid.engine.stable_step();
  double largest = 0.0;
  for (int part = 0; part < 20; ++part) {
    solid.run(50, dt, 0.3);
    largest = std::max(largest, entry(solid.engine.ledger(), "loads"));
    CHECK(std::fabs(solid.engine.ledger().balance()) < 1e-11 * std::max(largest, 1.0));
  }
  CHECK(largest > 1.0);
  for (const char* name : {"kinetic", "elastic", "gravity", "damping", "dashpots", "constraints"})
    CHECK(entry(solid.engine.ledger(), name) != 0.0);
  CHECK(entry(solid.engine.ledger(), "multipliers") == 0.0);
}

TEST_CASE("one and two threads give the same state") {
  std::uint64_t hash[2];
  for (const int threads : {1, 2}) {
    Solid solid(mixed_mesh(), soil);
    solid.engine.threads = threads;
    solid.engine.options.gravity = vec(0, 0, -9.81);
    solid.engine.prepare();
    solid.set_noise(solid.engine.motion.velocity, 1e-2);
    solid.run(60, 0.9 * solid.engine.stable_step(), 0.1);
    hash[threads - 1] = solid.engine.state_hash();
  }
  CHECK(hash[0] == hash[1]);
}

TEST_CASE("a restored state goes on bit for bit") {
  const auto fresh = [] {
    Solid solid(mixed_mesh(), soil);
    solid.engine.options.gravity = vec(0, 0, -9.81);
    solid.hold(
        "base", [](Vec x) { return x[0] == 0.0; }, 7);
    solid.engine.prepare();
    return solid.engine.stable_step();
  };
  const double dt = 0.7 * fresh();
  const auto set_up = [](Solid& solid) {
    solid.engine.options.gravity = vec(0, 0, -9.81);
    solid.hold(
        "base", [](Vec x) { return x[0] == 0.0; }, 7);
    solid.engine.prepare();
  };
  Solid unbroken(mixed_mesh(), soil), resumed(mixed_mesh(), soil);
  set_up(unbroken);
  unbroken.run(100, dt, 0.2);
  const auto blob = unbroken.engine.checkpoint();
  set_up(resumed);
  resumed.engine.restore(blob);
  resumed.time = unbroken.time;
  CHECK(resumed.engine.ledger().balance() == unbroken.engine.ledger().balance());
  unbroken.run(100, dt, 0.2);
  resumed.run(100, dt, 0.2);
  CHECK(unbroken.engine.state_hash() == resumed.engine.state_hash());
  CHECK(unbroken.engine.ledger().balance() == resumed.engine.ledger().balance());

  auto cut = blob;
  cut.pop_back();
  CHECK_THROWS_AS(resumed.engine.restore(cut), RequestError);
  cut[0] ^= 1;
  CHECK_THROWS_AS(resumed.engine.restore(cut), RequestError);
  Solid other(box_mesh({1, 1, 1}, vec(1, 1, 1)), soil);
  other.engine.prepare();
  CHECK_THROWS_AS(other.engine.restore(blob), RequestError);
}

TEST_CASE("preparing again keeps the motion, a new mesh starts afresh") {
  Solid solid(mixed_mesh(), soil);
  solid.engine.prepare();
  solid.set_noise(solid.engine.motion.displacement, 1e-3);
  const auto hash = solid.engine.state_hash();
  solid.engine.options.gravity = vec(0, 0, -9.81);
  solid.engine.prepare();
  CHECK(solid.engine.state_hash() == hash);
  solid.engine.set_mesh(mixed_mesh());
  solid.engine.prepare();
  CHECK(solid.engine.motion.largest_speed() == 0.0);
  CHECK(solid.engine.motion.displacement[5][0] == 0.0);
}

TEST_CASE("fields have their shapes, and only motion can be set") {
  Solid solid(mixed_mesh(), soil);
  solid.engine.prepare();
  for (const std::string& name : ContinuumEngine::field_names()) {
    CAPTURE(name);
    std::vector<std::uint64_t> shape;
    const auto values = solid.engine.field(name, shape);
    REQUIRE(values);
    CHECK(values->size() == shape[0] * (shape.size() > 1 ? shape[1] : 1));
  }
  std::vector<std::uint64_t> shape;
  CHECK_FALSE(solid.engine.field("spin", shape));
  std::vector<double> values(3 * solid.engine.motion.size());
  for (std::size_t i = 0; i < values.size(); ++i) values[i] = static_cast<double>(i);
  solid.engine.set_field("velocity", values);
  CHECK(solid.values("velocity") == values);
  CHECK(caught<RequestError>([&] { solid.engine.set_field("spin", values); }).where == "SET_FIELD.field");
  values.pop_back();
  CHECK(caught<RequestError>([&] { solid.engine.set_field("velocity", values); }).where == "SET_FIELD.values");
}

TEST_CASE("trouble names its entity") {
  SECTION("an element that is inverted at rest") {
    Mesh mesh = box_mesh({3, 1, 1}, vec(3, 1, 1));
    std::swap(mesh.elements[2][0], mesh.elements[2][6]);
    Solid solid(mesh, soil);
    const auto error = caught<RequestError>([&] { solid.engine.prepare(); });
    CHECK(error.where == "MESH.elements");
    CHECK(std::string(error.what()).find("element 2 ") != std::string::npos);
  }
  SECTION("an element that turns inside out") {
    Solid solid(box_mesh({3, 1, 1}, vec(3, 1, 1)), soil);
    solid.engine.prepare();
    solid.engine.motion.displacement[3] = vec(-1.5, 0, 0);
    const auto error = caught<PhysicsError>([&] { solid.run(1, 1e-6); });
    CHECK(error.where == "element 2");
  }
  SECTION("a velocity that is no number") {
    Solid solid(box_mesh({3, 1, 1}, vec(3, 1, 1)), soil);
    solid.engine.prepare();
    solid.engine.motion.velocity[5][1] = std::nan("");
    const auto error = caught<PhysicsError>([&] { solid.run(1, 1e-6); });
    CHECK(error.where == "node 5");
  }
  SECTION("the stable step before prepare") {
    Solid solid(box_mesh({3, 1, 1}, vec(3, 1, 1)), soil);
    CHECK(caught<RequestError>([&] { solid.engine.stable_step(); }).where == "STABLE_STEP");
  }
}

TEST_CASE("the unbalanced measure falls to nothing at rest under gravity") {
  Solid solid(box_mesh({2, 2, 4}, vec(2, 2, 4)), soil);
  solid.engine.options.gravity = vec(0, 0, -9.81);
  solid.hold(
      "base", [](Vec x) { return x[2] == 0.0; }, 7);
  solid.engine.prepare();
  const double dt = 0.69 * solid.engine.stable_step();
  solid.run(2, dt, 0.7);
  const double start = solid.engine.unbalanced();
  CHECK(start > 0.1);
  solid.run(3000, dt, 0.7);
  CHECK(solid.engine.unbalanced() < 1e-10);
  Vec reaction = vec(solid.engine.boundary.reactions()[0], solid.engine.boundary.reactions()[1],
                     solid.engine.boundary.reactions()[2]);
  CHECK(reaction[2] == Approx(9.81 * 1000 * 16).epsilon(1e-8));
}
