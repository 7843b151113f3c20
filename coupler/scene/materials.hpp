#pragma once
// Names in a scene resolved: materials from the scene, files beside it or the program; coupling keys of the model.

#include <filesystem>
#include <string>
#include <vector>

#include "coupler/scene/document.hpp"

namespace gabion::scene {

/// Replaces the materials section by the materials that ground and fills use. A name is looked for in the scene, as
/// folder/materials/NAME.json, and among the built-in ones, in this order.
void resolve_materials(Json& document, const std::filesystem::path& folder, std::vector<SceneProblem>& problems);

/// Replaces the coupling section by what holds for the scene's model: the common keys, overridden by those under
/// the model's name. Uncoupled models have none.
void resolve_coupling(Json& document);

}  // namespace gabion::scene
