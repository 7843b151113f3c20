#pragma once
// The scenes of the scenarios folder, for tests.

#include <algorithm>
#include <filesystem>
#include <string>
#include <vector>

#include "coupler/scene/read_scene.hpp"

namespace gabion::scene {

inline std::filesystem::path scenarios() {
  return std::filesystem::path(GABION_SOURCE_DIR) / "scenarios";
}

inline std::vector<std::filesystem::path> scene_files() {
  std::vector<std::filesystem::path> files;
  for (const auto& entry : std::filesystem::directory_iterator(scenarios()))
    if (entry.path().extension() == ".json" && entry.path().filename() != "scene.schema.json")
      files.push_back(entry.path());
  std::sort(files.begin(), files.end());
  return files;
}

inline ReadResult tiny(const std::vector<std::string>& overrides = {}) {
  return read_scene(scenarios() / "tiny.json", overrides);
}

}  // namespace gabion::scene
