#pragma once
// From a scene file to a Scene.
//
//   text -> JSON (comments) -> --set -> schema -> units -> defaults -> cross checks -> Scene

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "coupler/scene/problem.hpp"
#include "coupler/scene/scene.hpp"

namespace gabion::scene {

struct ReadResult {
  Scene scene;
  /// JSON text: the same keys with defaults and derived values, quantities in SI with their units. Can be read
  /// again as a scene and then has the same hash.
  std::string effective;
  /// Of the effective scene without what cannot change a result (title, expected, run.threads,
  /// run.checkpoint_every).
  std::uint64_t hash = 0;
  std::string hash_text;  ///< hash, 16 hexadecimal digits
  std::vector<SceneProblem> warnings;
};

/// Reads a scene file. overrides: "key.path=value", see apply_override. Throws SceneError with every problem that
/// was found.
ReadResult read_scene(const std::filesystem::path& file, const std::vector<std::string>& overrides = {});

/// The same from text. label: name of the file in messages and, without folder and ending, of the scene;
/// folder: where its materials folder is looked for.
ReadResult read_scene_text(const std::string& text, const std::string& label, const std::filesystem::path& folder,
                           const std::vector<std::string>& overrides = {});

}  // namespace gabion::scene
