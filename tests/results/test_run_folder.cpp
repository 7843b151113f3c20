#include "coupler/results/run_folder.hpp"

#include <catch2/catch.hpp>
#include <cmath>

#include "coupler/results/errors.hpp"
#include "fresh_folder.hpp"

using gabion::coupler::RunFolder;
using gabion::coupler::RunFolderError;

namespace fs = std::filesystem;

TEST_CASE("a run folder is made with its parents and keeps a log") {
  const auto path = fresh_folder("run") / "deep" / "run-1";
  RunFolder folder(path);
  folder.log("first");
  folder.log("second");
  const std::string log = content(path / "run.log");
  CHECK_THAT(log, Catch::Contains(" s  first\n") && Catch::EndsWith(" s  second\n"));
}

TEST_CASE("a folder with content is refused and left alone") {
  const auto path = fresh_folder("run_full");
  std::ofstream(path / "summary.json") << "old";
  CHECK_THROWS_WITH(RunFolder(path), Catch::Contains("not empty") && Catch::Contains("summary.json") &&
                                         Catch::Contains("--overwrite"));
  CHECK(content(path / "summary.json") == "old");
  CHECK_THROWS_AS(RunFolder(path / "summary.json"), RunFolderError);
}

TEST_CASE("the engines' logs do not count as content") {
  const auto path = fresh_folder("run_logs");
  std::ofstream(path / "dem_server.log") << "listening";
  CHECK_NOTHROW(RunFolder(path));
  CHECK(content(path / "dem_server.log") == "listening");
}

TEST_CASE("replacing removes an earlier run's files and nothing else") {
  const auto path = fresh_folder("run_again");
  for (const char* name : {"summary.json", "energy.csv", "results.h5", "continuum_server.log"})
    std::ofstream(path / name) << "old";
  RunFolder(path, RunFolder::Existing::replace);
  CHECK(!fs::exists(path / "summary.json"));
  CHECK(!fs::exists(path / "energy.csv"));
  CHECK(!fs::exists(path / "results.h5"));
  CHECK(fs::exists(path / "continuum_server.log"));

  std::ofstream(path / "energy.csv") << "old";
  std::ofstream(path / "thesis.tex") << "years of work";
  CHECK_THROWS_WITH(RunFolder(path, RunFolder::Existing::replace), Catch::Contains("thesis.tex"));
  CHECK(fs::exists(path / "thesis.tex"));
  CHECK(fs::exists(path / "energy.csv"));
}

TEST_CASE("json has sorted keys, exact numbers, null for what is not finite, and no draft stays behind") {
  const auto path = fresh_folder("run_json");
  RunFolder folder(path);
  nlohmann::json summary;
  summary["wall"] = {{"total", 0.1}};
  summary["energy"] = NAN;
  summary["scene"] = "triaxial";
  folder.write_json("summary.json", summary);
  CHECK(content(path / "summary.json") ==
        "{\n  \"energy\": null,\n  \"scene\": \"triaxial\",\n  \"wall\": {\n    \"total\": 0.1\n  }\n}\n");
  CHECK(!fs::exists(path / "summary.json.tmp"));
  folder.write_text("summary.json", "{}");
  CHECK(content(path / "summary.json") == "{}");
}
