#include "coupler/scene/schema_node.hpp"

#include "coupler/scene/schema.hpp"
#include "coupler/scene/units.hpp"

namespace gabion::scene {

Json resolved(const Json& node) {
  if (!node.contains("$ref")) return node;
  const std::string reference = node["$ref"];  // "#/definitions/name"
  Json result = resolved(schema().at(Json::json_pointer(reference.substr(1))));
  for (const auto& [key, value] : node.items())
    if (key != "$ref") result[key] = value;
  return result;
}

bool has_type(const Json& value, const std::string& type) {
  if (type == "object") return value.is_object();
  if (type == "array") return value.is_array();
  if (type == "string") return value.is_string();
  if (type == "boolean") return value.is_boolean();
  if (type == "integer") return value.is_number_integer();
  return value.is_number();
}

namespace {

/// A string may be a word or a quantity: no anyOf of the schema offers both.
bool may_be(const Json& value, const Json& alternative) {
  if (alternative.contains("unit")) return value.is_string() || value.is_number();
  if (alternative.contains("enum")) return value.is_string();
  return has_type(value, alternative.at("type"));
}

}  // namespace

const Json* choose_alternative(const Json& value, const Json& node, std::vector<std::string>& keys) {
  const Json* only_object = nullptr;
  std::size_t objects = 0;
  for (const Json& raw : node["anyOf"]) {
    const Json alternative = resolved(raw);
    if (alternative.contains("anyOf")) {  // a nested choice, as velocity: components, or a history
      if (choose_alternative(value, alternative, keys) != nullptr) return &raw;
      continue;
    }
    if (alternative.value("type", Json()) == "object") {
      ++objects;
      only_object = &raw;
      const Json required = alternative.value("required", Json::array());
      if (!required.empty()) keys.push_back(required.front());
      if (value.is_object() && !required.empty() && value.contains(required.front())) return &raw;
    } else if (may_be(value, alternative)) {
      return &raw;
    }
  }
  return value.is_object() && objects == 1 && keys.empty() ? only_object : nullptr;
}

const Json& item_node(const Json& node, std::size_t index) {
  const Json& items = node["items"];
  return items.is_array() ? items[index] : items;
}

const Json* property_node(const Json& node, const std::string& key) {
  if (node.contains("properties") && node["properties"].contains(key)) return &node["properties"][key];
  const Json& others = node["additionalProperties"];
  return others.is_object() ? &others : nullptr;
}

std::vector<std::string> property_names(const Json& node) {
  std::vector<std::string> names;
  if (node.contains("properties"))
    for (const auto& item : node["properties"].items()) names.push_back(item.key());
  return names;
}

std::vector<std::string> choice_words(const Json& node) {
  std::vector<std::string> words;
  for (const Json& choice : node["enum"])
    words.push_back(choice.is_string() ? choice.get<std::string>() : choice.dump());
  return words;
}

std::string type_phrase(const Json& node) {
  if (node.contains("anyOf")) {
    std::string text;
    for (const Json& raw : node["anyOf"]) text += (text.empty() ? "" : ", or ") + type_phrase(resolved(raw));
    return text;
  }
  if (node.contains("unit")) return describe_unit(node["unit"].get<std::string>());
  if (node.contains("enum")) return "one of " + listed(choice_words(node));
  const std::string type = node["type"];
  if (type == "object") {
    const Json required = node.value("required", Json::array());
    return required.empty() ? "an object { ... }" : "an object with " + required.front().get<std::string>();
  }
  if (type == "array") {
    const bool fixed_length =
        node.contains("minItems") && node.contains("maxItems") && node["minItems"] == node["maxItems"];
    return fixed_length ? "a list of " + node["minItems"].dump() : "a list [ ... ]";
  }
  if (type == "boolean") return "true or false";
  if (type == "integer") return "a whole number";
  return type == "string" ? "text in quotes" : "a number";
}

}  // namespace gabion::scene
