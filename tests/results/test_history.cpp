#include "coupler/results/history.hpp"

#include <catch2/catch.hpp>
#include <cmath>
#include <cstdlib>
#include <limits>

#include "coupler/results/errors.hpp"
#include "fresh_folder.hpp"

using gabion::coupler::History;
using gabion::coupler::ResultsError;
using gabion::coupler::shortest;

TEST_CASE("a history has a header with units and one line a row") {
  const auto path = fresh_folder("history") / "energy.csv";
  {
    History history(path, {"time [s]", "kinetic [J]"});
    history.append({0.0, 0.1});
    history.append({1e-9, -2.5e300});
    CHECK(history.rows() == 2);
  }
  CHECK(content(path) == "time [s],kinetic [J]\n0,0.1\n1e-09,-2.5e+300\n");
}

TEST_CASE("numbers of a history read back to the same bits") {
  for (const double value : {0.1, 1.0 / 3.0, 5e-324, std::numeric_limits<double>::max(), -123456.789e-7}) {
    CAPTURE(value);
    CHECK(std::strtod(shortest(value).c_str(), nullptr) == value);
  }
  CHECK(shortest(-std::numeric_limits<double>::quiet_NaN()) == "nan");
  CHECK(shortest(-INFINITY) == "-inf");
}

TEST_CASE("rows reach the disk at every full chunk and at flush") {
  const auto path = fresh_folder("history_flush") / "a.csv";
  History history(path, {"a"}, 2);
  CHECK(content(path) == "a\n");
  history.append({1.0});
  history.append({2.0});
  CHECK(content(path) == "a\n1\n2\n");
  history.append({3.0});
  CHECK(content(path) == "a\n1\n2\n");
  history.flush();
  CHECK(content(path) == "a\n1\n2\n3\n");
}

TEST_CASE("a history refuses what would not read back as a table") {
  const auto folder = fresh_folder("history_bad");
  CHECK_THROWS_AS(History(folder / "a.csv", {}), ResultsError);
  CHECK_THROWS_AS(History(folder / "a.csv", {"x, y"}), ResultsError);
  CHECK_THROWS_WITH(History(folder / "a.csv", {"x", "x"}), Catch::Contains("'x' stands twice"));
  CHECK_THROWS_WITH(History(folder / "none" / "a.csv", {"x"}), Catch::Contains("cannot write"));
  History history(folder / "a.csv", {"x", "y"});
  CHECK_THROWS_WITH(history.append({1.0}), Catch::Contains("1 numbers for 2 columns"));
}
