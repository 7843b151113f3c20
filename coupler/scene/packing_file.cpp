#include "coupler/scene/packing_file.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <fstream>
#include <sstream>
#include <stdexcept>

namespace gabion::scene {

PackingFile read_packing_file(const std::filesystem::path& file) {
  std::ifstream in(file);
  if (!in) throw std::runtime_error("there is no file " + file.string());
  PackingFile packing;
  std::string line;
  for (std::size_t number = 1; std::getline(in, line); ++number) {
    line = line.substr(0, line.find('#'));
    std::replace(line.begin(), line.end(), ',', ' ');
    std::istringstream words(line);
    std::array<double, 4> row{};
    std::size_t count = 0;
    for (double value = 0.0; count < row.size() && words >> value; ++count) row[count] = value;
    if (count == 0 && (words >> std::ws).eof()) continue;
    const std::string where = "row " + std::to_string(number) + " of " + file.string();
    if (count == row.size()) words >> std::ws;
    const bool finite = std::all_of(row.begin(), row.end(), [](double value) { return std::isfinite(value); });
    if (count != row.size() || !words.eof() || !finite) throw std::runtime_error(where + " is not four numbers x y z radius");
    if (!(row[3] > 0.0)) throw std::runtime_error(where + " has a radius that is not above 0");
    packing.position.push_back({row[0], row[1], row[2]});
    packing.radius.push_back(row[3]);
  }
  if (packing.radius.empty()) throw std::runtime_error(file.string() + " holds no grains");
  return packing;
}

}  // namespace gabion::scene
