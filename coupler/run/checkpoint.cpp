#include "coupler/run/checkpoint.hpp"

#include <fstream>
#include <iterator>

#include "coupler/results/errors.hpp"
#include "coupler/results/run_folder.hpp"

namespace gabion::coupler {

namespace {

constexpr const char* format = "gabion checkpoint 1";

}  // namespace

void write_checkpoint(const std::filesystem::path& file, const nlohmann::json& state) {
  nlohmann::json whole = state;
  whole["format"] = format;
  std::string bytes;
  nlohmann::json::to_cbor(whole, bytes);
  write_atomically(file, bytes);
}

nlohmann::json read_checkpoint(const std::filesystem::path& path, const std::string& scene_hash) {
  const std::filesystem::path file = std::filesystem::is_directory(path) ? path / checkpoint_name : path;
  std::ifstream in(file, std::ios::binary);
  if (!in) throw RunFolderError("--resume: no checkpoint at " + file.string() + "; runs write one where run.checkpoint_every is set, and when they are interrupted");
  const std::string bytes((std::istreambuf_iterator<char>(in)), {});
  constexpr bool strict = true, throws = false;
  nlohmann::json state = nlohmann::json::from_cbor(bytes, strict, throws);
  if (state.is_discarded() || !state.is_object() || state.value("format", "") != format)
    throw RunFolderError("--resume: " + file.string() + " is not a checkpoint of this version of Gabion");
  if (state.at("scene_hash") != scene_hash)
    throw RunFolderError("--resume: " + file.string() + " is of another scene (" + state.at("scene_hash").get<std::string>() +
                         ", this one is " + scene_hash + "); give the scene.effective.json beside the checkpoint, without --set");
  return state;
}

}  // namespace gabion::coupler
