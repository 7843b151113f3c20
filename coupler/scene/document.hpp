#pragma once
// A scene as JSON before it is understood: text, comments, --set.

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "coupler/scene/problem.hpp"

namespace gabion::scene {

using Json = nlohmann::json;

/// The whole file as text; a SceneError names the file that cannot be read.
std::string read_text(const std::filesystem::path& path);

/// JSON with // and /* */ comments. Syntax errors and keys given twice become problems; then the result is of no
/// use.
Json parse_document(const std::string& text, std::vector<SceneProblem>& problems);

/// Applies "key.path=value". Steps of the path are separated by dots, items of lists are written list[2] or list.2;
/// an index equal to the length of the list adds an item. The value is read as JSON if it is JSON, as text
/// otherwise; null removes the key. Missing objects on the way are made: the schema tells later whether
/// they are known.
void apply_override(Json& document, const std::string& override_text, std::vector<SceneProblem>& problems);

/// The value at a key path such as stages[1].name, or nullptr.
const Json* find_path(const Json& document, const std::string& path);

}  // namespace gabion::scene
