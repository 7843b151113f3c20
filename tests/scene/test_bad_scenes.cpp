// A user's mistakes, and what the program says about them.

#include <catch2/catch.hpp>

#include "coupler/scene/document.hpp"
#include "tests/scene/scene_files.hpp"

using namespace gabion::scene;

namespace {

struct Mistake {
  std::vector<std::string> overrides;
  std::string path;    ///< of the problem
  std::string phrase;  ///< part of "path: value, expected ...; advice"
};

const SceneProblem* at(const std::vector<SceneProblem>& problems, const std::string& path) {
  for (const SceneProblem& problem : problems)
    if (problem.path == path) return &problem;
  return nullptr;
}

void check_mistakes(const std::string& scene, const std::vector<Mistake>& mistakes) {
  for (const Mistake& mistake : mistakes) {
    INFO(scene << " --set " << mistake.overrides.back());
    try {
      read_scene(scenarios() / scene, mistake.overrides);
      CHECK(mistake.path == "found");  // read without complaint
    } catch (const SceneError& error) {
      INFO(error.what());
      const SceneProblem* problem = at(error.problems(), mistake.path);
      REQUIRE(problem != nullptr);
      CHECK(problem->text().find(mistake.phrase) != std::string::npos);
      CHECK_FALSE(problem->value.empty());
      CHECK_FALSE((problem->expected.empty() && problem->advice.empty()));
      CHECK(std::string(error.what()).find(scene + ": " + problem->text()) != std::string::npos);
    }
  }
}

}  // namespace

TEST_CASE("rates of the mesh that make no sense") {
  check_mistakes("tiny.json", {
      {{"mesh.rates={\"first_layers\": 1}"}, "mesh.rates.first_layers", "with fewer than 2 layers at the grains' own step the two media resonate"},
      {{"mesh.rates={\"largest\": 6}"}, "mesh.rates.largest", "6, expected a power of two"},
      {{"mesh.rates={\"largest\": 64}"}, "mesh.rates.largest", "at most 32"},
      {{"mesh.rates={\"largest\": \"most\"}"}, "mesh.rates.largest", "auto"},
      {{"mesh.rates={\"layers\": 0}"}, "mesh.rates.layers", "at least 1"},
      {{"mesh.rates={\"layer\": 3}"}, "mesh.rates.layer", "did you mean 'layers'?"},
  });
}

TEST_CASE("unknown, missing and mistyped keys") {
  check_mistakes("tiny.json", {
      {{"grains.radios=1"}, "grains.radios", "unknown key; did you mean 'radius'? known here: bond_gap, contacts_per_grain,"},
      {{"mash={}"}, "mash", "did you mean 'mesh'?"},
      {{"colour=red"}, "colour", "unknown key; known here: block, coupling"},
      {{"stages[0].dampng=0.1"}, "stages[0].dampng", "did you mean 'damping'?"},
      {{"faces.top=free"}, "faces.top", "known here: xmax, xmin, ymax"},
      {{"faces.zmax={\"presure\": \"1 kPa\"}"}, "faces.zmax.presure", "did you mean 'pressure'? known here: pressure, traction, velocity, displace"},
      {{"faces.zmax={}"}, "faces.zmax", "one of the keys pressure, traction"},
      {{"faces.zmax.pressure.half_sin={}", "faces.zmax.pressure.half_sine=null"}, "faces.zmax.pressure.half_sin", "did you mean 'half_sine'?"},
      {{"coupling.edge.row=edge"}, "coupling.edge.row", "did you mean 'rows'?"},
      {{"gabion=null"}, "gabion", "missing, expected one of 1"},
      {{"ground.box=null"}, "ground.box", "missing, expected a list of 2, such as"},
      {{"stages=null"}, "stages", "missing"},
      {{"mesh.size=null"}, "mesh.size", "missing, expected a length"},
      {{"stages[0].name=null"}, "stages[0].name", "missing, expected text in quotes"},
      {{"faces.zmax.pressure.half_sine.duration=null"}, "faces.zmax.pressure.half_sine.duration", "missing, expected a time"},
      {{"stages=[]"}, "stages", "a list of 0, expected at least 1 items"},
      {{"stages={}"}, "stages", "{}, expected a list [ ... ]"},
      {{"grains=5"}, "grains", "5, expected an object with radius"},
      {{"gravity=[0,0]"}, "gravity", "a list of 2, expected 3 items, such as"},
      {{"title=5"}, "title", "5, expected text in quotes"},
      {{"grains.seed=1.5"}, "grains.seed", "1.5, expected a whole number"},
      {{"grains.seed=-1"}, "grains.seed", "-1, expected at least 0"},
      {{"run.measure_energy=maybe"}, "run.measure_energy", "'maybe', expected true or false"},
      {{"faces.zmin=5"}, "faces.zmin", "5, expected one of free, fixed, roller, seat, absorbing, or an object with pressure"},
      {{"gabion=2"}, "gabion", "2, expected 1"},
  });
}

TEST_CASE("packings from files") {
  check_mistakes("rigid_box.json", {
      {{"grains.file=data/rigid_bx.txt"}, "grains.file", "there is no file"},
      {{"grains.file=null"}, "grains.file", "missing, expected a file with one grain a row"},
      {{"grains.file=rigid_box.json"}, "grains.file", "is not four numbers x y z radius"},
      {{"grains.bond_gap=-0.1"}, "grains.bond_gap", "expected at least 0"},
      {{"faces.xmin={\"wall\": {}}"}, "faces.xmin.wall.friction", "missing"},
  });
}

TEST_CASE("unknown words") {
  check_mistakes("tiny.json", {
      {{"model=brigding"}, "model", "'brigding', expected one of dem, continuum, bridging, edge; did you mean 'bridging'?"},
      {{"faces.zmin=rollr"}, "faces.zmin", "did you mean 'roller'?"},
      {{"grains.packing=hcp"}, "grains.packing", "'hcp', expected one of random, fcc, sc"},
      {{"coupling.bridging.rows=mortar_2h"}, "coupling.bridging.rows", "did you mean 'mortar2h'?"},
      {{"mesh.element=tet"}, "mesh.element", "expected brick"},
      {{"ground.periodic=[\"w\"]"}, "ground.periodic[0]", "expected one of x, y, z"},
      {{"grains.geometry=frozn"}, "grains.geometry", "did you mean 'frozen'?"},
      {{"output.fields=[\"stresses\"]"}, "output.fields[0]", "did you mean 'stress'?"},
      {{"ground.material=seedsoil"}, "ground.material", "did you mean 'seed_soil'? known here: gravel_clumps, gravel_locked, gravel_rolling, seed_gravel, seed_soil, soil; define it under 'materials' or in materials/seedsoil.json"},
      {{"fills=[{\"box\": [[0,0,0],[\"1 m\",\"1 m\",\"1 m\"]], \"material\": \"lava\"}]"}, "fills[0].material", "'lava', expected the name of a material"},
  });
}

TEST_CASE("quantities with a wrong unit, no unit or nonsense") {
  check_mistakes("tiny.json", {
      {{"mesh.size=0.4"}, "mesh.size", "0.4, expected a length, such as '0.5 m' or '57 mm'; write the unit behind the number, '0.4 m'"},
      {{"mesh.size=\"0.4\""}, "mesh.size", "write the unit behind the number"},
      {{"mesh.size=0.4 s"}, "mesh.size", "'0.4 s', expected a length, such as '0.5 m' or '57 mm'; the unit measures something else"},
      {{"mesh.size=0.4 ft"}, "mesh.size", "unknown unit 'ft'"},
      {{"mesh.size=wide"}, "mesh.size", "it does not begin with a number"},
      {{"mesh.size=infinite"}, "mesh.size", "it must be finite"},
      {{"mesh.size=true"}, "mesh.size", "true, expected a length"},
      {{"faces.zmax={\"pressure\": \"10 kN\"}"}, "faces.zmax.pressure", "expected a stress, such as '500 MPa'"},
      {{"grains.solid_fraction=0.6 m"}, "grains.solid_fraction", "expected a number without unit"},
      {{"ground.box[1][2]=2.4 kg"}, "ground.box[1][2]", "expected a length"},
      {{"stages[0].duration=15 m"}, "stages[0].duration", "expected a time, such as '0.5 s'"},
      {{"gravity=[0,0,-9.81]"}, "gravity[2]", "expected an acceleration, such as '-9.81 m/s2'"},
      {{"gravity=[0,0,\"down\"]"}, "gravity[2]", "expected an acceleration"},
      {{"gravity[2]=-9.81 m/s2"}, "gravity", "set 'gravity' as a whole"},
      {{"materials={\"seed_soil\": {\"normal_stiffness\": \"1 GPa\", \"shear_stiffness\": \"1 GPa\", \"density\": \"2.6 t\"}}"}, "materials.seed_soil.density", "expected a density"},
  });
}

TEST_CASE("values out of range") {
  check_mistakes("tiny.json", {
      {{"grains.radius.uniform[0]=-1 cm"}, "grains.radius.uniform[0]", "'-1 cm', expected above 0 m"},
      {{"grains.radius=0 m"}, "grains.radius", "'0 m', expected above 0 m"},
      {{"mesh.size=0"}, "mesh.size", "0, expected above 0 m"},
      {{"grains.solid_fraction=0.9"}, "grains.solid_fraction", "expected at least 0.1 and at most 0.74; random packings"},
      {{"grains.solid_fraction=0.05"}, "grains.solid_fraction", "expected at least 0.1"},
      {{"grains.contacts_per_grain=1"}, "grains.contacts_per_grain", "expected at least 3 and at most 12"},
      {{"grains.min_contacts=20"}, "grains.min_contacts", "at most 12; 3 removes the grains that nothing holds"},
      {{"stages[0].damping=1"}, "stages[0].damping", "expected at least 0 and below 1; 0 in dynamics, 0.69 in quasi-static stages"},
      {{"stages[0].damping=-0.1"}, "stages[0].damping", "expected at least 0"},
      {{"run.step_fraction=1.2"}, "run.step_fraction", "above 0 and at most 1; steps above the stable one blow up"},
      {{"run.step_fraction=0"}, "run.step_fraction", "above 0"},
      {{"coupling.weight_floor=0.6"}, "coupling.weight_floor", "expected above 0 and at most 0.5"},
      {{"coupling.weight_floor=0"}, "coupling.weight_floor", "expected above 0"},
      {{"coupling.reach=0"}, "coupling.reach", "0.8 to 1.3 for edge"},
      {{"mesh.grading=0.5"}, "mesh.grading", "at least 1"},
      {{"stages[0].duration=-1 ms"}, "stages[0].duration", "expected above 0 s"},
      {{"stages[0].until={\"unbalanced\": 0}"}, "stages[0].until.unbalanced", "above 0"},
      {{"materials={\"seed_soil\": {\"normal_stiffness\": \"1 GPa\", \"shear_stiffness\": \"1 GPa\", \"friction\": -0.5}}"}, "materials.seed_soil.friction", "expected at least 0; 0: frictionless"},
      {{"materials={\"seed_soil\": {\"normal_stiffness\": \"1 GPa\", \"shear_stiffness\": \"1 GPa\", \"normal_strength\": \"-1 Pa\"}}"}, "materials.seed_soil.normal_strength", "0: no bonds"},
      {{"materials={\"seed_soil\": {\"normal_stiffness\": \"1 GPa\", \"shear_stiffness\": \"1 GPa\", \"poisson\": 0.5}}"}, "materials.seed_soil.poisson", "0.4999 is accepted"},
      {{"materials={\"seed_soil\": {\"normal_stiffness\": \"1 GPa\", \"shear_stiffness\": \"1 GPa\", \"restitution\": 0}}"}, "materials.seed_soil.restitution", "expected above 0 and at most 1; 1: no contact damping"},
      {{"materials={\"seed_soil\": {\"normal_stiffness\": \"1 GPa\", \"shear_stiffness\": \"1 GPa\", \"restitution\": 1.5}}"}, "materials.seed_soil.restitution", "1.5, expected above 0 and at most 1"},
      {{"materials={\"seed_soil\": {\"normal_stiffness\": \"1 GPa\", \"shear_stiffness\": \"1 GPa\", \"rolling_stiffness\": -1}}"}, "materials.seed_soil.rolling_stiffness", "expected at least 0"},
      {{"materials={\"seed_soil\": {\"normal_stiffness\": \"1 GPa\", \"shear_stiffness\": \"1 GPa\", \"rolling_friction\": \"-0.1\"}}"}, "materials.seed_soil.rolling_friction", "rolling resistance needs rolling_stiffness too"},
      {{"materials={\"seed_soil\": {\"normal_stiffness\": \"1 GPa\", \"shear_stiffness\": \"1 GPa\", \"rotation\": \"lockd\"}}"}, "materials.seed_soil.rotation", "did you mean 'locked'"},
      {{"run.threads=0"}, "run.threads", "at least 1"},
      {{"laboratory={}"}, "laboratory.confinements", "confinements"},
      {{"laboratory={\"confinements\": [\"0 kPa\"]}"}, "laboratory.confinements[0]", "above 0 Pa"},
      {{"laboratory={\"confinements\": [], \"damping\": 1}"}, "laboratory.damping", "0.2 to 0.7"},
  });
  check_mistakes("impact.json", {
      {{"block.mass=0 t"}, "block.mass", "'0 t', expected above 0 kg"},
      {{"block.mass=-10 t"}, "block.mass", "expected above 0 kg"},
      {{"block.side=0 m"}, "block.side", "above 0 m"},
      {{"block.velocity=-13 m/s"}, "block.velocity", "a single value is a speed downwards"},
      {{"block.friction=-1"}, "block.friction", "at least 0"},
  });
}

TEST_CASE("places and sizes that do not fit one another") {
  check_mistakes("tiny.json", {
      {{"ground.box[1][0]=-1 m"}, "ground.box", "a lower corner below the upper one in x"},
      {{"grains.radius.uniform=[\"10 cm\",\"5 cm\"]"}, "grains.radius.uniform", "expected the smaller radius first; swap the two values"},
      {{R"(grains.radius={"sieve": [["5 cm", 0.5], ["10 cm", 0.5]]})"}, "grains.radius.sieve", "expected at least two sieves, radii rising, shares passing from 0 to 1"},
      {{R"(grains.radius={"sieve": [["5 cm", 0], ["5 cm", 0.5], ["10 cm", 1]]})"}, "grains.radius.sieve", "radii rising"},
      {{"grains.radius.uniform=[\"0.3 m\",\"0.6 m\"]"}, "grains.radius", "grains that fit into the ground, whose smallest side is 0.8 m"},
      {{"coupling.bridging.zone[1][2]=3 m"}, "coupling.bridging.zone", "expected a box inside the ground; compare with ground.box"},
      {{"coupling.bridging.zone[1][2]=-1 m"}, "coupling.bridging.zone", "a lower corner below the upper one in z"},
      {{"coupling.bridging.zone=null"}, "grains.zone", "missing, expected a box with a face inside the ground"},
      {{"coupling.bridging.zone[1][2]=2.4 m"}, "coupling.bridging.zone", "make the zone smaller than the ground, or use model = dem"},
      {{"coupling.bridging.overlap=0.35 m"}, "coupling.bridging.overlap", "'0.35 m', expected at least 1 element, 0.4 m; make the overlap wider"},
      {{"coupling.bridging.overlap=1.7 m"}, "coupling.bridging.overlap", "leaves grains alone inside the zone, below 1.6 m along z"},
      {{"mesh.size=0.3 m"}, "mesh.size", "'0.3 m', expected at least 2.5 mean grain diameters, 0.375 m"},
      {{"mesh.size=0.9 m", "coupling.bridging.overlap=1 m"}, "mesh.size", "at most the smallest side of the ground, 0.8 m"},
      {{"probes[0].at[2]=3 m"}, "probes[0].at", "expected a point of the ground"},
      {{"probes[1].name=head"}, "probes[1].name", "a name that no other probe has"},
      {{"fills=[{\"box\": [[\"2 m\",0,0],[\"3 m\",\"1 m\",\"1 m\"]], \"material\": \"soil\"}]"}, "fills[0].box", "a box that meets the ground"},
      {{"model=dem", "grains=null"}, "grains", "missing, expected the grains' radius"},
      {{"mesh=null"}, "mesh", "missing, expected the element size"},
  });
  check_mistakes("tiny_lattice.json", {
      {{"grains.radius={\"uniform\": [\"5 cm\", \"10 cm\"]}"}, "grains.radius", "one radius for the lattice 'fcc'"},
      {{"grains.radius=6 cm"}, "ground.box", "a whole number of lattice cells along the periodic direction x"},
      {{"ground.box[1][1]=0.7 m", "probes=[]", "coupling.bridging.zone[1][1]=0.7 m"}, "ground.box", "along the periodic direction y, such as 0.6 m (3 cells of 0.2 m)"},
  });
  check_mistakes("impact.json", {
      {{"block.position=[\"0 m\",\"0 m\",\"1 m\"]"}, "block.position", "a height of the centre of at least 1.342339 m"},
      {{"block.position=[\"5 m\",\"0 m\"]"}, "block.position", "a place above the grains, x from -4.5 m to 4.5 m"},
      {{"coupling.bridging.zone[1][2]=-0.1 m"}, "coupling.bridging.zone", "a zone that reaches the top of the ground"},
  });
  check_mistakes("lattice_wave.json", {
      {{"initial.wave.centre=40 m"}, "initial.wave.centre", "a place inside the ground, z from -32 m to 32 m"},
  });
}

TEST_CASE("choices that do not fit one another") {
  check_mistakes("tiny.json", {
      {{"model=edge", "coupling.rows=mortar"}, "coupling.rows", "'mortar', expected one of edge, edge_projected, edge_hats for model = edge; move it to coupling.bridging.rows"},
      {{"coupling.bridging.rows=edge_hats"}, "coupling.bridging.rows", "one of mortar, mortar2h, strict for model = bridging; move it to coupling.edge.rows"},
      {{"model=edge", "coupling.sponge={\"strength\": 12.8}"}, "coupling.sponge", "put it into coupling.bridging"},
      {{"coupling.rows=strict", "coupling.sponge={\"strength\": 12.8}"}, "coupling.sponge", "no sponge with rows = strict"},
      {{"coupling.solve=row_sum"}, "coupling.solve", "'row_sum', expected exact, unless rows = strict"},
      {{"stages[0].duration=null"}, "stages[0].duration", "missing, expected an end of the stage 'pulse'; give one of duration"},
      {{"stages[0].name="}, "stages[0].name", "a name that is not empty"},
      {{"stages[1]={\"name\": \"pulse\", \"steps\": 3}"}, "stages[1].name", "a name that no other stage has"},
      {{"ground.periodic=[\"x\"]"}, "faces.xmin", "'roller', expected 'free', because the ground is periodic across this face"},
      {{"ground.periodic=[\"z\"]", "gravity=[0,0,\"-9.81 m/s2\"]"}, "gravity[2]", "0 along a periodic direction"},
      {{"faces.zmax={\"traction\": \"1 kPa\", \"direction\": [0,0,0]}"}, "faces.zmax.direction", "a direction, such as"},
      {{"faces.zmax={\"velocity\": \"1 mm/s\"}"}, "faces.zmax.direction", "missing"},
      {{"faces.zmax={\"velocity\": [0,0,0]}"}, "faces.zmax.velocity", "a face at rest is 'fixed'"},
      {{"faces.zmax={\"velocity\": [0,0,\"1 m/s\"], \"direction\": \"z\"}"}, "faces.zmax.direction", "remove one of the two"},
      {{"faces.zmax={\"pressure\": {\"table\": [[\"1 s\", 0], [\"1 s\", 0]]}}"}, "faces.zmax.pressure.table[1]", "a time after that of the row above"},
      {{"grains.geometry=frozen", "ground.material=seed_gravel"}, "materials.seed_gravel.normal_strength", "frozen contacts cannot break"},
      {{"mesh.stiffness=material", "materials={\"seed_soil\": {\"normal_stiffness\": \"1 GPa\", \"shear_stiffness\": \"1 GPa\"}}"}, "materials.seed_soil.young", "mesh.stiffness = material takes young"},
  });
  check_mistakes("impact.json", {
      {{"model=continuum"}, "block", "no block with model = continuum; the block acts on grains: use dem, bridging or edge, or --set block=null"},
      {{"block.stage=impct"}, "block.stage", "the name of a stage: settle, impact; did you mean 'impact'?"},
      {{"grains.geometry=frozen", "fills=[]"}, "grains.geometry", "frozen grains find no new contacts"},
  });
}

TEST_CASE("whatever stands in a scene, it is read or refused") {
  const std::vector<Json> odd{nullptr, true, 0, -1, 1e300, "", "x", "1 m", "-1e30 kg", "infinite", Json::array(), Json::object(),
                              Json::array({1, "2 m"}), Json::object({{"value", 1}})};
  for (const char* name : {"impact.json", "lattice_wave.json"}) {
    const Json scene = Json::parse(read_scene(scenarios() / name).effective);
    std::size_t refused = 0, read = 0;
    const Json leaves = scene.flatten();
    for (const auto& leaf : leaves.items())
      for (const Json& value : odd) {
        Json changed = scene;
        changed[Json::json_pointer(leaf.key())] = value;
        INFO(name << " " << leaf.key() << " = " << value);
        try {
          read_scene_text(changed.dump(), "odd.json", "/nowhere");
          ++read;
        } catch (const SceneError&) {
          ++refused;
        }
      }
    CHECK(refused > 5 * read);
  }
}

TEST_CASE("several problems are told at once") {
  try {
    tiny({"grains.radios=1", "mesh.size=4", "model=dm", "stages[0].damping=2"});
    FAIL("a wrong scene was read");
  } catch (const SceneError& error) {
    CHECK(error.problems().size() == 4);
  }
}

TEST_CASE("clumps where they cannot be") {
  check_mistakes("tiny_clumps.json", {
      {{"materials.cushion.clump_size=0"}, "materials.cushion.clump_size", "expected at least 1"},
      {{"grains.geometry=frozen"}, "materials.cushion.clump_size", "1 while grains.geometry = frozen"},
      {{"ground.material=cushion"}, "materials.cushion.clump_size", "1 for the material of the ground in a coupled model"},
      {{"fills[0].box[0][2]=1.5 m"}, "fills[0].box", "clumps cannot be tied"},
      {{"model=edge", "fills[0].box[0][2]=1 m"}, "fills[0].box", "clumps cannot be tied"},
  });
  CHECK(read_scene(scenarios() / "tiny_clumps.json", {"model=dem", "fills[0].box[0][2]=0 m"}).scene.materials.size() == 2);
  CHECK(read_scene(scenarios() / "tiny_clumps.json", {}).scene.material("cushion").clump_size == 4);
}

TEST_CASE("warnings do not stop") {
  const auto warned = [](const std::string& scene, const std::vector<std::string>& overrides, const std::string& path) {
    const auto read = read_scene(scenarios() / scene, overrides);
    INFO(scene << " --set " << overrides.back());
    return at(read.warnings, path) != nullptr;
  };
  CHECK(warned("tiny.json", {"model=edge", "coupling.edge.rows=edge_projected"}, "coupling.edge.rows"));
  CHECK(warned("tiny.json", {"coupling.rows=mortar2h"}, "coupling.rows"));
  CHECK(warned("tiny.json", {"coupling.bridging.overlap=0.7 m"}, "coupling.bridging.overlap"));
  CHECK_FALSE(warned("tiny.json", {"coupling.bridging.overlap=0.8 m"}, "coupling.bridging.overlap"));
  CHECK(warned("tiny.json", {"coupling.rows=strict", "coupling.solve=row_sum"}, "coupling.solve"));
  CHECK(warned("tiny.json", {"gravity=[0,0,\"-9.81 m/s2\"]", "faces.zmin=absorbing"}, "gravity"));
  CHECK(warned("tiny.json", {"stages[0].until={\"unbalanced\": 1e-3}"}, "stages[0].damping"));
  CHECK(warned("lattice_wave.json", {"initial.wave.wavelength=0.5 m"}, "initial.wave.wavelength"));
  CHECK(warned("lattice_wave.json", {"model=dem", "initial.wave.wavelength=0.5 m"}, "initial.wave.wavelength"));
  const std::string wide = R"(fills[0].box=[["-2 m","-2 m","-2 m"],["4 m","2 m","0 m"]])";
  CHECK(warned("impact.json", {wide}, "fills[0].box"));
  CHECK(warned("impact.json", {"model=edge", wide}, "fills[0].box"));
  CHECK_FALSE(warned("impact.json", {"model=dem", wide}, "fills[0].box"));
  CHECK_FALSE(warned("impact.json", {"model=bridging"}, "fills[0].box"));
  CHECK_FALSE(warned("tiny.json", {"gravity=[0,0,\"-9.81 m/s2\"]"}, "gravity"));
}
