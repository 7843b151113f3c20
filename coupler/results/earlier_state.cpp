#include "coupler/results/earlier_state.hpp"

#include <cstdio>
#include <stdexcept>
#include <string>
#include <unordered_map>

#include "coupler/results/hdf5.hpp"

namespace gabion::coupler {

namespace {

std::vector<double> rows_of(const std::vector<double>& values, const std::vector<std::size_t>& place) {
  std::vector<double> chosen;
  for (const std::size_t row : place) chosen.insert(chosen.end(), &values[3 * row], &values[3 * row] + 3);
  return chosen;
}

}  // namespace

EarlierState read_earlier_state(const std::filesystem::path& file, const std::vector<std::int32_t>& origin) {
  const hdf5::Handle results = hdf5::open_file(file);
  const std::size_t states = hdf5::read(results, "states/time").data.size();
  if (states == 0) throw std::runtime_error("initial.state: " + file.string() + " holds no state");
  char name[40];
  std::snprintf(name, sizeof name, "grains/state_%06zu/", states - 1);
  const std::vector<double> numbers = hdf5::read(results, "grains/origin_id").data;
  std::unordered_map<std::int64_t, std::size_t> row_of;
  for (std::size_t row = 0; row < numbers.size(); ++row) row_of[static_cast<std::int64_t>(numbers[row])] = row;
  std::vector<std::size_t> place;
  for (const std::int32_t grain : origin) {
    const auto found = row_of.find(grain);
    if (found == row_of.end())
      throw std::runtime_error("initial.state: " + file.string() + " lacks grain " + std::to_string(grain) +
                               " of the packing; give a run of the same ground, seed and grains, with model = dem");
    place.push_back(found->second);
  }
  EarlierState state;
  std::vector<double> displacement = hdf5::read(results, name + std::string("displacement")).data;
  if (hdf5::exists(results, name + std::string("zeroed_displacement"))) {
    const std::vector<double> zeroed = hdf5::read(results, name + std::string("zeroed_displacement")).data;
    for (std::size_t k = 0; k < displacement.size(); ++k) displacement[k] += zeroed[k];
  }
  state.displacement = rows_of(displacement, place);
  if (hdf5::exists(results, name + std::string("rotation")))
    state.rotation = rows_of(hdf5::read(results, name + std::string("rotation")).data, place);
  return state;
}

}  // namespace gabion::coupler
