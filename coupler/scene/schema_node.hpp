#pragma once
// Questions about one node of the schema, for the walks along it.

#include <string>
#include <vector>

#include "coupler/scene/document.hpp"

namespace gabion::scene {

/// The node with its $ref followed; keys beside $ref win over those it refers to.
Json resolved(const Json& node);

/// Whether a value has a type of JSON schema ("object", "integer" ...).
bool has_type(const Json& value, const std::string& type);

/// The alternative of an anyOf node that a value means: by its type and, among objects, by the first required key.
/// nullptr: none; then keys holds the first required keys of all alternative objects.
const Json* choose_alternative(const Json& value, const Json& node, std::vector<std::string>& keys);

/// Node of the item with this index, for lists and for tuples.
const Json& item_node(const Json& node, std::size_t index);

/// Node of a key of an object, nullptr: unknown key.
const Json* property_node(const Json& node, const std::string& key);
std::vector<std::string> property_names(const Json& node);

/// The enumerated values as words.
std::vector<std::string> choice_words(const Json& node);

/// "a list of 3 items", "one of free, fixed, or an object with pressure" ...
std::string type_phrase(const Json& node);

}  // namespace gabion::scene
