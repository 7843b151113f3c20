#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <fstream>
#include <iomanip>
#include <sstream>
#include <nlohmann/json.hpp>
#include <numbers>

#include "coupler/scene/packing_file.hpp"
#include "coupler/scene/read_scene.hpp"
#include "coupler/scene/schema.hpp"
#include "tests/scene/scene_files.hpp"

using namespace gabion::scene;

namespace {

std::vector<std::string> models_of(const std::filesystem::path& file) {
  if (file.stem() == "impact" || file.stem() == "tiny_clumps") return {"dem", "bridging", "edge"};
  if (file.stem() == "rigid_box" || file.stem() == "sphere_drop") return {"dem"};
  return {"dem", "continuum", "bridging", "edge"};
}

}  // namespace

TEST_CASE("every scene is read in every model by one word") {
  REQUIRE(scene_files().size() >= 9);
  for (const auto& file : scene_files())
    for (const std::string& model : models_of(file)) {
      INFO(file << " as " << model);
      const ReadResult read = read_scene(file, {"model=" + model});
      CHECK(to_string(read.scene.model) == model);
      CHECK(read.scene.name == file.stem());
      for (const SceneProblem& warning : read.warnings) UNSCOPED_INFO(warning.text());
      CHECK(read.warnings.empty());
      if (model == "bridging") CHECK(read.scene.coupling.rows == "mortar");
      if (model == "edge") CHECK(read.scene.coupling.rows == "edge");
    }
}

TEST_CASE("the effective scene is the same scene") {
  for (const auto& file : scene_files())
    for (const std::string& model : models_of(file)) {
      INFO(file << " as " << model);
      const ReadResult first = read_scene(file, {"model=" + model});
      const ReadResult second = read_scene_text(first.effective, "effective.json", "/nowhere");
      CHECK(second.effective == first.effective);
      CHECK(second.hash == first.hash);
      CHECK(second.scene.grains.radius == first.scene.grains.radius);
      CHECK(second.scene.stages.size() == first.scene.stages.size());
      CHECK(second.scene.mesh.size == first.scene.mesh.size);
    }
}

TEST_CASE("the effective scene has defaults, derived values and units") {
  const auto effective = nlohmann::json::parse(tiny().effective);
  CHECK(effective["grains"]["solid_fraction"] == 0.63);
  CHECK(effective["coupling"]["rows"] == "mortar");
  CHECK(effective["coupling"]["overlap"] == "0.8 m");
  CHECK(effective["faces"]["zmax"]["pressure"]["half_sine"]["amplitude"] == "100000 Pa");
  CHECK(effective["faces"]["zmax"]["pressure"]["half_sine"]["start"] == "0 s");
  CHECK(effective["materials"]["seed_soil"]["friction"] == "infinite");
  CHECK(effective["materials"]["seed_soil"]["young"] == "500000000 Pa");
  CHECK(effective["run"]["step_fraction"] == 0.9);
  CHECK_FALSE(effective.contains("block"));
}

TEST_CASE("the hash follows what changes a result, and nothing else") {
  const auto hash = tiny().hash;
  CHECK(tiny({"title=other", "run.threads=2", "expected.x=1", "run.checkpoint_every=10 s"}).hash == hash);
  CHECK(tiny({"mesh.size=400 mm"}).hash == hash);
  CHECK(tiny({"grains.seed=2"}).hash != hash);
  CHECK(tiny({"model=edge"}).hash != hash);
  CHECK(tiny({"coupling.weight_floor=0.02"}).hash != hash);
  CHECK(tiny({"ground.material=seed_gravel"}).hash != hash);
  CHECK(tiny().hash_text.size() == 16);
}

TEST_CASE("the reach of an edge tie follows from rows, packing and stiffness ratio, and shows in the effective scene") {
  const auto reach = [](std::vector<std::string> changes) {
    changes.insert(changes.begin(), "model=edge");
    return tiny(changes).scene.coupling.reach;
  };
  const double ratio = std::log(1.13 / 3.78);  // k_s/k_n of seed_soil
  CHECK(reach({}) == Approx(1.30 + 0.20 * ratio));
  CHECK(reach({"coupling.border_weights=false"}) == Approx(0.885 + 0.085 * ratio));
  CHECK(reach({"coupling.edge.rows=edge_hats"}) == 1.25);
  CHECK(reach({"coupling.edge.rows=edge_projected"}) == 0.9);
  CHECK(reach({"coupling.edge.reach=1"}) == 1.0);
  const auto read = tiny({"model=edge"});
  CHECK(read.scene.coupling.border_weights);
  CHECK(Json::parse(read.effective)["coupling"]["reach"] == read.scene.coupling.reach);
  CHECK_FALSE(tiny({}).scene.coupling.border_weights);
}

TEST_CASE("coupling keys of a model win over the common ones") {
  const auto read = tiny({"coupling.reach=0.8", "coupling.edge.reach=1.1", "coupling.edge.rows=edge_hats"});
  CHECK(read.scene.coupling.reach == 0.8);
  const auto edge =
      tiny({"model=edge", "coupling.reach=0.8", "coupling.edge.reach=1.1", "coupling.edge.rows=edge_hats"});
  CHECK(edge.scene.coupling.reach == 1.1);
  CHECK(edge.scene.coupling.rows == "edge_hats");
  REQUIRE(edge.scene.grains.zone);
  CHECK(edge.scene.grains.zone->hi[2] == 1.2);
  CHECK(tiny({"coupling.bridging.overlap=null", "mesh.size=0.3 m", "grains.radius.uniform=[\"4 cm\",\"8 cm\"]"})
            .scene.coupling.overlap == Approx(1.2));
}

TEST_CASE("materials come from the scene, a file beside it, or the program") {
  CHECK(tiny().scene.material("seed_soil").normal_stiffness == 3.78e9);
  const std::string own =
      R"(materials={"seed_soil": {"normal_stiffness": "1 GPa", "shear_stiffness": "0.2 GPa", "friction": 0.5}})";
  const ReadResult read = tiny({own});
  CHECK(read.scene.materials.size() == 1);
  CHECK(read.scene.material("seed_soil").normal_stiffness == 1e9);
  CHECK(read.scene.material("seed_soil").friction == 0.5);
  CHECK(read.scene.material("seed_soil").normal_strength == infinity);
  CHECK(read.scene.material("seed_soil").density == 2650);
  CHECK_FALSE(read.scene.material("seed_soil").young);
  CHECK(read.scene.material("seed_soil").rolling_stiffness == 0.0);
  CHECK(read.scene.material("seed_soil").rolling_friction == 0.0);
  CHECK(read.scene.material("seed_soil").restitution == 1.0);
  CHECK(read.scene.material("seed_soil").rotates);
  const Material lossy = tiny({R"(materials={"seed_soil": {"normal_stiffness": "1 GPa", "shear_stiffness": "0.2 GPa",
      "rolling_stiffness": 0.5, "rolling_friction": "infinite", "restitution": 0.3, "rotation": "locked"}})"})
                             .scene.material("seed_soil");
  CHECK(lossy.rolling_stiffness == 0.5);
  CHECK(lossy.rolling_friction == infinity);
  CHECK(lossy.restitution == 0.3);
  CHECK_FALSE(lossy.rotates);
  CHECK_THROWS_AS(read.scene.material("clay"), std::out_of_range);

  const auto folder = std::filesystem::path(GABION_BINARY_DIR) / "scene_materials";
  std::filesystem::create_directories(folder / "materials");
  std::ofstream(folder / "materials/clay.json") << R"({"normal_stiffness": "2 GPa", "shear_stiffness": "0"} // soft)";
  const ReadResult file = read_scene_text(tiny().effective, "x.json", folder, {"ground.material=clay"});
  CHECK(file.scene.material("clay").normal_stiffness == 2e9);

  std::ofstream(folder / "materials/wrong.json") << R"({"normal_stifness": "2 GPa", "shear_stiffness": "0"})";
  try {
    read_scene_text(tiny().effective, "x.json", folder, {"ground.material=wrong"});
    FAIL("a wrong material was read");
  } catch (const SceneError& error) {
    CHECK(
        std::string(error.what()).find("wrong.json: normal_stifness: unknown key; did you mean 'normal_stiffness'?") !=
        std::string::npos);
  }
}

TEST_CASE("built-in materials are those of the scenarios folder") {
  for (const char* name : {"seed_soil", "seed_gravel", "soil"}) {
    const auto beside = tiny({std::string("ground.material=") + name});
    const auto built_in =
        read_scene_text(tiny().effective, "x.json", "/nowhere", {std::string("ground.material=") + name});
    CHECK(beside.scene.material(name).normal_stiffness == built_in.scene.material(name).normal_stiffness);
    CHECK(beside.scene.material(name).shear_stiffness == built_in.scene.material(name).shear_stiffness);
    CHECK(beside.scene.material(name).shear_stiffness > 0);
  }
}

TEST_CASE("faces become conditions and histories") {
  const auto face = [](const std::string& text) { return tiny({"faces.zmax=" + text}).scene.faces[5]; };
  CHECK(face("free").kind == "free");
  CHECK(face("absorbing").kind == "absorbing");
  Face f = face(R"({"pressure": "10 kPa"})");
  CHECK(f.kind == "pressure");
  CHECK(f.history.kind == "constant");
  CHECK(f.history.parameters == std::vector<double>{1e4});
  f = face(R"({"pressure": {"half_sine": {"amplitude": "1 MPa", "start": "1 ms", "duration": "5 ms"}}})");
  CHECK(f.history.kind == "half_sine");
  CHECK(f.history.parameters == std::vector<double>{1e6, 1e-3, 5e-3});
  f = face(R"({"pressure": {"ramp": {"value": "1 MPa", "rise": "5 ms"}}})");
  CHECK(f.history.parameters == std::vector<double>{1e6, 0, 5e-3});
  f = face(R"({"traction": {"table": [["0 s", "0"], ["2 ms", "3 kPa"]]}, "direction": [3, 0, -4]})");
  CHECK(f.kind == "traction");
  CHECK(f.history.parameters == std::vector<double>{0, 0, 2e-3, 3e3});
  CHECK(f.direction[0] == Approx(0.6));
  CHECK(f.direction[2] == Approx(-0.8));
  f = face(R"({"velocity": ["0", "3 mm/s", "-4 mm/s"]})");
  CHECK(f.kind == "velocity");
  CHECK(f.history.parameters[0] == Approx(5e-3));
  CHECK(f.direction[1] == Approx(0.6));
  f = face(R"({"velocity": "2 m/s", "direction": "-x"})");
  CHECK(f.direction == Point{-1, 0, 0});
  CHECK(f.history.parameters == std::vector<double>{2});
}

TEST_CASE("displace moves a face by the distance and then holds it") {
  const Face f =
      tiny({R"(faces.zmax={"displace": {"by": "-0.3 mm", "over": "20 ms"}, "direction": "z"})"}).scene.faces[5];
  CHECK(f.kind == "velocity");
  REQUIRE(f.history.kind == "half_sine");
  const double amplitude = f.history.parameters[0], duration = f.history.parameters[2];
  // integral of a half-sine: 2 amplitude duration / pi
  CHECK(2 * amplitude * duration / std::numbers::pi == Approx(-3e-4).epsilon(1e-14));
  CHECK(duration == 0.02);
  CHECK(f.direction == Point{0, 0, 1});
}

TEST_CASE("equilibrium is not looked for before the stage's loads have acted") {
  const Scene scene = read_scene(scenarios() / "triaxial.json").scene;
  CHECK(scene.stages[0].at_least == 0.0);
  CHECK(scene.stages[1].at_least == Approx(0.02));
  CHECK(scene.stages[1].faces.size() == 1);
  CHECK(scene.stages[1].faces[0].first == 5);
  CHECK(std::isinf(scene.stages[1].duration));
  CHECK(read_scene(scenarios() / "triaxial.json", {"stages[1].at_least=50 ms"}).scene.stages[1].at_least == 0.05);
}

TEST_CASE("histories can be shifted in time") {
  CHECK(shifted({"half_sine", {5, 1, 2}}, 10).parameters == std::vector<double>{5, 11, 2});
  CHECK(shifted({"ramp", {5, 1, 2}}, 10).parameters == std::vector<double>{5, 11, 2});
  CHECK(shifted({"table", {0, 5, 1, 6}}, 10).parameters == std::vector<double>{10, 5, 11, 6});
  CHECK(shifted({"constant", {5}}, 10).parameters == std::vector<double>{5});
}

TEST_CASE("grain sizes in three forms") {
  const Grains uniform = tiny().scene.grains;
  CHECK(uniform.radius == std::vector<double>{0.05, 0.1});
  CHECK(mean_diameter(uniform) == Approx(0.15));
  const Grains one = tiny({"grains.radius=6 cm"}).scene.grains;
  CHECK(one.radius == std::vector<double>{0.06, 0.06});
  const Grains sieve = tiny({R"(grains.radius={"sieve": [["5 cm", 0], ["8 cm", 0.4], ["10 cm", 1]]})"}).scene.grains;
  CHECK(sieve.radius_kind == "sieve");
  CHECK(sieve.radius == std::vector<double>{0.05, 0.0, 0.08, 0.4, 0.1, 1.0});
  double count = 0.0, length = 0.0;  // numbers go with mass over r^3
  for (double r = 0.05 + 5e-6; r < 0.1; r += 1e-5) {
    const double number = (r < 0.08 ? 0.4 / 0.03 : 0.6 / 0.02) / (r * r * r);
    count += number;
    length += number * 2 * r;
  }
  CHECK(mean_diameter(sieve) == Approx(length / count).epsilon(1e-6));
  const Grains lattice = read_scene(scenarios() / "tiny_lattice.json").scene.grains;
  CHECK(lattice.radius.size() == 1);
  CHECK(lattice.geometry == "frozen");
}

TEST_CASE("grains from a file bring their radii, and walls their friction") {
  const ReadResult read = read_scene(scenarios() / "rigid_box.json");
  const Grains& grains = read.scene.grains;
  CHECK(grains.packing == "file");
  const PackingFile file = read_packing_file(grains.file);
  CHECK(file.radius.size() == 7033);
  CHECK(grains.radius.front() == Approx(*std::min_element(file.radius.begin(), file.radius.end())).epsilon(1e-9));
  CHECK(grains.radius.back() == Approx(*std::max_element(file.radius.begin(), file.radius.end())).epsilon(1e-9));
  CHECK(read.scene.faces[4].kind == "wall");
  CHECK(read.scene.faces[4].friction == 1.0);
  CHECK(read.scene.faces[5].kind == "free");
  // the effective scene names the file whole, so that it can be read from elsewhere
  const ReadResult again = read_scene_text(read.effective, "again.json", "/", {});
  CHECK(again.scene.grains.file == grains.file);
  CHECK(again.hash == read.hash);
}

TEST_CASE("the block is placed, pointed and released") {
  const Scene scene = read_scene(scenarios() / "impact.json").scene;
  REQUIRE(scene.block);
  CHECK(scene.block->mass == 1e4);
  CHECK(scene.block->velocity == Point{0, 0, -13});
  CHECK(scene.block->touching);
  CHECK(scene.block->stage == 1);
  CHECK(scene.block->rotation);
  const Scene other = read_scene(scenarios() / "impact.json",
                                 {"block.position=[\"1 m\",\"0\",\"3 m\"]", "block.velocity=[\"1 m/s\",0,\"-2 m/s\"]",
                                  "block.rotation=locked", "block.stage=null"})
                          .scene;
  CHECK_FALSE(other.block->touching);
  CHECK(other.block->position == Point{1, 0, 3});
  CHECK(other.block->velocity == Point{1, 0, -2});
  CHECK_FALSE(other.block->rotation);
  CHECK(other.block->stage == 1);
  CHECK_FALSE(read_scene(scenarios() / "impact.json", {"block=null", "model=continuum"}).scene.block);
}

TEST_CASE("the rest of the keys arrive") {
  const Scene scene =
      tiny({"gravity=[0,0,\"-9.81 m/s2\"]", "run.threads={\"dem\": 2}", "run.step=1e-5 s", "run.energy_tolerance=1 %",
            "output.every=2 ms", "output.fields=[\"stress\"]", "stages[0].steps=7", "grains.rotations=locked",
            "mesh.grading=1.2", "mesh.stiffness=material", "coupling.rotation_limit=3 deg"})
          .scene;
  CHECK(scene.gravity == Point{0, 0, -9.81});
  CHECK(scene.run.threads_dem == 2);
  CHECK(scene.run.threads_continuum == 1);
  CHECK(scene.run.step == 1e-5);
  CHECK(scene.run.energy_tolerance == 0.01);
  CHECK(scene.output.every == 2e-3);
  CHECK(scene.output.fields == std::vector<std::string>{"stress"});
  CHECK(scene.stages[0].steps == 7);
  CHECK_FALSE(scene.grains.rotations);
  CHECK(scene.mesh.grading == 1.2);
  CHECK(scene.coupling.rotation_limit == Approx(3 * std::numbers::pi / 180));
  CHECK_FALSE(scene.mesh.rates);
  const Scene automatic = tiny({"mesh.rates={}"}).scene, chosen = tiny({"mesh.rates={\"largest\": 8, \"nested\": false, \"layers\": 3, \"first_layers\": 5}"}).scene;
  REQUIRE(automatic.mesh.rates);
  CHECK(automatic.mesh.rates->largest == 0);
  CHECK(automatic.mesh.rates->nested);
  CHECK(automatic.mesh.rates->layers == 6);
  CHECK(automatic.mesh.rates->first_layers == 2);
  REQUIRE(chosen.mesh.rates);
  CHECK(chosen.mesh.rates->largest == 8);
  CHECK_FALSE(chosen.mesh.rates->nested);
  CHECK(chosen.mesh.rates->layers == 3);
  CHECK(chosen.mesh.rates->first_layers == 5);
  const Scene wave = read_scene(scenarios() / "lattice_wave.json").scene;
  REQUIRE(wave.wave);
  CHECK(wave.wave->axis == 2);
  CHECK(wave.wave->sense == -1.0);
  CHECK(wave.wave->wavelength == 2.4);
  CHECK(wave.ground.periodic == std::array<bool, 3>{true, true, false});
  CHECK(wave.coupling.sponge.strength == 25.6);
}

TEST_CASE("laboratory tests arrive, and a scene without them has none") {
  CHECK_FALSE(tiny().scene.laboratory);
  const Scene scene = tiny({"laboratory={\"confinements\": [\"20 kPa\", \"1 bar\"], \"damping\": 0.5}"}).scene;
  REQUIRE(scene.laboratory);
  CHECK(scene.laboratory->confinements == std::vector<double>{20e3, 100e3});
  CHECK(scene.laboratory->damping == 0.5);
  CHECK(scene.laboratory->axial_strain == 0.1);
  CHECK(scene.laboratory->max_steps == 200000);
}

TEST_CASE("a file that cannot be read is named") {
  try {
    read_scene("/nowhere/scene.json");
    FAIL("a missing file was read");
  } catch (const SceneError& error) {
    CHECK(std::string(error.what()) ==
          "/nowhere/scene.json: cannot be read; check the name and the permissions of the file");
  }
}

TEST_CASE("the validator is a second opinion on structure") {
  const auto complaints = [](const std::string& text) {
    std::vector<SceneProblem> problems;
    validate_structure(Json::parse(text), problems);
    return problems.size();
  };
  CHECK(complaints(tiny().effective) == 0);
  Json scene = Json::parse(tiny().effective);
  scene["mesh"]["size"] = true;
  CHECK(complaints(scene.dump()) > 0);
  scene = Json::parse(tiny().effective);
  scene["grains"]["radios"] = 1;
  CHECK(complaints(scene.dump()) > 0);
  scene = Json::parse(tiny().effective);
  scene.erase("stages");
  CHECK(complaints(scene.dump()) > 0);
}

TEST_CASE("a scene far away counts from an origin of its own") {
  const Scene near = tiny().scene;
  CHECK(near.origin == Point{});
  const auto moved = [](const std::string& by, int axis) {
    const auto at = [&](double x, double y, double z) {
      std::string text = "[";
      const double values[] = {x, y, z};
      for (int a = 0; a < 3; ++a) {
        std::ostringstream number;
        number << std::setprecision(16) << (a == axis ? std::stod(by) : 0.0) + values[a];
        text += (a ? ", \"" : "\"") + number.str() + " m\"";
      }
      return text + "]";
    };
    return tiny({"ground.box=[" + at(0, 0, 0) + "," + at(0.8, 0.8, 2.4) + "]",
                 "coupling.bridging.zone=[" + at(0, 0, 0) + "," + at(0.8, 0.8, 1.6) + "]", "probes[0].at=" + at(0.4, 0.4, 2.4),
                 "probes[1].at=" + at(0.4, 0.4, 1.2)});
  };
  for (const int axis : {0, 1, 2})
    for (const double by : {1e6, -1e6, 3e5}) {
      CAPTURE(axis, by);
      const ReadResult far = moved(std::to_string(by), axis);
      CHECK(far.scene.origin[axis] == by);
      CHECK(far.scene.ground.box.hi == near.ground.box.hi);  // the same bits
      CHECK(far.scene.grains.zone->hi == near.grains.zone->hi);
      CHECK(far.scene.probes[0].at == near.probes[0].at);
      CHECK(far.effective.find(std::to_string(std::lround(by)).substr(0, 3)) != std::string::npos);  // as the user wrote it
    }
  // near the origin nothing changes, whatever the place
  CHECK(moved("7.3", 0).scene.origin == Point{});
  CHECK(moved("7.3", 0).scene.ground.box.lo[0] == 7.3);
}

TEST_CASE("a zone left open is read, and is nobody's box yet") {
  const ReadResult read = tiny({"coupling.bridging.zone=\"auto\"", "mesh.size=0.01 m"});  // the mesh will be chosen too
  CHECK(read.scene.grains.zone_to_choose);
  CHECK_FALSE(read.scene.grains.zone.has_value());
  const auto effective = nlohmann::json::parse(read.effective);
  CHECK(effective["coupling"]["zone"] == "auto");
  CHECK(effective["coupling"]["target_error"] == 0.03);
  CHECK_FALSE(tiny().scene.grains.zone_to_choose);
  CHECK_FALSE(tiny({"coupling.bridging.zone=\"auto\"", "model=edge"}).scene.grains.zone_to_choose);
  CHECK_THROWS_AS(tiny({"coupling.bridging.zone=\"large\""}), SceneError);
}
