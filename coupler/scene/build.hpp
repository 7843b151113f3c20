#pragma once
// A Scene from values: a document read by the schema, in SI numbers, complete with defaults.

#include "coupler/scene/document.hpp"
#include "coupler/scene/scene.hpp"

namespace gabion::scene {

/// Values that follow from others are filled in and written back, so that the effective scene shows them:
/// overlap, border_weights, reach, at_least of the stages, stage of the block.
Scene build_scene(Json& values, const std::string& name);

}  // namespace gabion::scene
