#include "coupler/results/results_file.hpp"

#include <hdf5.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <catch2/catch.hpp>

#include "coupler/results/errors.hpp"
#include "fresh_folder.hpp"
#include "sample.hpp"

using gabion::coupler::ResultsError;
using gabion::coupler::ResultsFile;

namespace {

std::vector<double> read(const std::filesystem::path& path, const std::string& dataset) {
  H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);
  const hid_t file = H5Fopen(path.c_str(), H5F_ACC_RDONLY, H5P_DEFAULT);
  const hid_t data = H5Dopen2(file, dataset.c_str(), H5P_DEFAULT);
  std::vector<double> values;
  if (data >= 0) {
    const hid_t space = H5Dget_space(data);
    values.resize(static_cast<std::size_t>(H5Sget_simple_extent_npoints(space)));
    H5Dread(data, H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data());
    H5Sclose(space);
    H5Dclose(data);
  }
  if (file >= 0) H5Fclose(file);
  return values;
}

}  // namespace

TEST_CASE("states read back, periodic nodes repeated and stress in the drawn order") {
  const auto path = fresh_folder("h5") / "results.h5";
  {
    ResultsFile file(path);
    file.attribute("scene", "sample");
    sample::geometry(file);
    for (int k = 0; k < 3; ++k) sample::state(file, k);
    CHECK(file.states() == 3);
    file.close();
    file.close();
    CHECK_THROWS_WITH(file.begin_state(0, 0), Catch::Contains("after close"));
  }
  CHECK(read(path, "/states/time") == std::vector<double>{0, 0.5, 1});
  CHECK(read(path, "/states/step") == std::vector<double>{0, 10, 20});
  CHECK(read(path, "/grains/radius") == sample::radius);
  CHECK(read(path, "/grains/state_000002/displacement") == sample::counted(9, 200));
  const auto u = read(path, "/mesh/state_000001/displacement");
  const auto source = read(path, "/mesh/node");
  REQUIRE(u.size() == 36);
  for (std::size_t k = 0; k < source.size(); ++k) CHECK(u[3 * k] == 1000 + 3 * source[k]);
  const auto stress = read(path, "/mesh/state_000001/stress");
  REQUIRE(stress.size() == 12);
  CHECK(std::vector<double>(stress.begin() + 6, stress.end()) ==
        std::vector<double>{10006, 10007, 10008, 10011, 10009, 10010});
  CHECK(read(path, "/interface/state_000002/jump") == sample::counted(6, 2));
  CHECK(read(path, "/block/state_000002/vertices") == sample::counted(9, 2));
}

TEST_CASE("the VTKHDF files show the same values through virtual datasets") {
  const auto folder = fresh_folder("vtkhdf");
  {
    ResultsFile file(folder / "results.h5");
    sample::geometry(file);
    for (int k = 0; k < 3; ++k) sample::state(file, k);
  }
  const auto u = read(folder / "grains.vtkhdf", "/VTKHDF/PointData/displacement");
  const auto start = read(folder / "grains.vtkhdf", "/VTKHDF/Steps/PointDataOffsets/displacement");
  CHECK(start == std::vector<double>{0, 3, 6});
  REQUIRE(u.size() == 27);
  CHECK(std::vector<double>(u.begin() + 9, u.begin() + 18) == sample::counted(9, 100));
  CHECK(read(folder / "grains.vtkhdf", "/VTKHDF/Points") == sample::position);
  CHECK(read(folder / "grains.vtkhdf", "/VTKHDF/PointData/radius") == sample::radius);
  CHECK(read(folder / "grains.vtkhdf", "/VTKHDF/Steps/PointDataOffsets/radius") == std::vector<double>{0, 0, 0});
  CHECK(read(folder / "mesh.vtkhdf", "/VTKHDF/Connectivity") == read(folder / "results.h5", "/mesh/elements"));
  CHECK(read(folder / "mesh.vtkhdf", "/VTKHDF/Offsets") == std::vector<double>{0, 8, 16});
  CHECK(read(folder / "mesh.vtkhdf", "/VTKHDF/CellData/stress").size() == 36);
}

TEST_CASE("an array that some state lacks stays out of the VTKHDF files") {
  const auto folder = fresh_folder("vtkhdf_uneven");
  {
    ResultsFile file(folder / "results.h5");
    sample::geometry(file);
    sample::state(file, 0);
    file.begin_state(1, 1);
    file.grain_field("displacement", sample::counted(9, 1), 3);
    file.end_state();
  }
  CHECK(read(folder / "grains.vtkhdf", "/VTKHDF/PointData/displacement").size() == 18);
  CHECK(read(folder / "grains.vtkhdf", "/VTKHDF/PointData/broken_bonds").empty());
}

TEST_CASE("wrong calls are refused with the name of the field") {
  ResultsFile file(fresh_folder("h5_bad") / "results.h5");
  CHECK_THROWS_WITH(file.end_state(), Catch::Contains("without begin_state"));
  file.write_grain_geometry({sample::position, sample::radius, {}, {}, {}});
  CHECK_THROWS_WITH(file.write_grain_geometry({sample::position, sample::radius, {}, {}, {}}),
                    Catch::Contains("written before"));
  CHECK_THROWS_WITH(file.grain_field("spin", {}, 3), Catch::Contains("grains/spin outside begin_state"));
  file.begin_state(0, 0);
  CHECK_THROWS_WITH(file.grain_field("spin", sample::counted(6, 0), 3),
                    Catch::Contains("grains/spin has 6 values, expected 3 x 3"));
  CHECK_THROWS_WITH(file.node_field("velocity", {}, 3), Catch::Contains("without geometry of mesh"));
  file.grain_field("spin", sample::counted(9, 0), 3);
  CHECK_THROWS_WITH(file.grain_field("spin", sample::counted(9, 0), 3), Catch::Contains("create dataset spin"));
  CHECK_THROWS_WITH(file.write_mesh_geometry({}), Catch::Contains("before the first state"));
  CHECK_THROWS_AS(ResultsFile("/no/such/folder/results.h5"), ResultsError);
}

TEST_CASE("a run that is killed in the middle of a state leaves the states before readable") {
  const auto folder = fresh_folder("h5_killed");
  const pid_t child = fork();
  REQUIRE(child >= 0);
  if (child == 0) {
    ResultsFile file(folder / "results.h5");
    sample::geometry(file);
    for (int k = 0; k < 200; ++k) sample::state(file, k);
    file.begin_state(200, 200);
    for (int k = 0; k < 200; ++k) file.grain_field("field" + std::to_string(k), sample::counted(9, 0), 3);
    kill(getpid(), SIGKILL);
  }
  int status = 0;
  waitpid(child, &status, 0);
  REQUIRE(WIFSIGNALED(status));
  CHECK(read(folder / "results.h5", "/states/time").size() == 200);
  CHECK(read(folder / "results.h5", "/grains/state_000199/displacement") == sample::counted(9, 19900));
  CHECK_THAT(content(folder / "results.xdmf"), Catch::EndsWith("</Grid>\n</Grid>\n</Domain>\n</Xdmf>\n") &&
                                                   Catch::Contains("state_000199") && !Catch::Contains("field0"));
}

// Read by check_paraview.py.
TEST_CASE("sample for ParaView") {
  ResultsFile file(fresh_folder("paraview") / "results.h5");
  sample::geometry(file);
  for (int k = 0; k < 3; ++k) sample::state(file, k);
  CHECK(file.states() == 3);
}
