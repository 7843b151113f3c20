#pragma once
// The schema of scenes (scenarios/scene.schema.json, embedded in the program) and what it says about a document:
// structure, units, ranges, defaults.

#include <optional>
#include <string>
#include <vector>

#include "coupler/scene/document.hpp"
#include "coupler/scene/problem.hpp"

namespace gabion::scene {

/// The schema as text and as JSON.
const std::string& schema_text();
const Json& schema();

/// Text of a built-in material, or nothing.
std::optional<std::string> builtin_material(const std::string& name);
std::vector<std::string> builtin_materials();

/// Reads a document by the schema: known keys only, right types, quantities turned into SI numbers, ranges,
/// defaults filled in. What is wrong is appended to problems, with paths that begin with the given one.
/// definition: name under "definitions", empty for a whole scene.
Json read_by_schema(const Json& document, std::vector<SceneProblem>& problems, const std::string& definition = "",
                    const std::string& path = "");

/// The inverse: SI numbers of a document read by the schema become text with units. Nothing else changes.
Json write_by_schema(const Json& values);

/// The second opinion of a validator that knows nothing of units (valijson). Only asked about documents in which
/// read_by_schema has found no fault.
void validate_structure(const Json& document, std::vector<SceneProblem>& problems);

}  // namespace gabion::scene
