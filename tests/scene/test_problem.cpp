#include <catch2/catch.hpp>

#include "coupler/scene/problem.hpp"

using namespace gabion::scene;

TEST_CASE("a problem reads as one sentence") {
  CHECK(SceneProblem{"a.b", "'3'", "a length", "add a unit"}.text() == "a.b: '3', expected a length; add a unit");
  CHECK(SceneProblem{"a.b", "missing", "", ""}.text() == "a.b: missing");
  CHECK(SceneProblem{"", "cannot be read", "", "check"}.text() == "cannot be read; check");
}

TEST_CASE("an error shows ten problems and counts the rest") {
  const std::vector<SceneProblem> many(13, {"p", "v", "", ""});
  const SceneError error("file.json", many);
  const std::string text = error.what();
  CHECK(std::count(text.begin(), text.end(), '\n') == 10);
  CHECK(text.find("file.json: p: v\n") == 0);
  CHECK(text.find("and 3 more") != std::string::npos);
  CHECK(error.problems().size() == 13);
}

TEST_CASE("the nearest word is what was meant, or nothing") {
  const std::vector<std::string> known{"radius", "rotations", "seed", "solid_fraction", "zone"};
  CHECK(nearest("radios", known) == "radius");
  CHECK(nearest("raduis", known) == "radius");
  CHECK(nearest("Radius", known) == "radius");
  CHECK(nearest("solidfraction", known) == "solid_fraction");
  CHECK(nearest("rot", known) == "rotations");
  CHECK(nearest("colour", known).empty());
  CHECK(nearest("", known).empty());
  CHECK(suggestion("zome", known) == "did you mean 'zone'? known here: radius, rotations, seed, solid_fraction, zone");
}
