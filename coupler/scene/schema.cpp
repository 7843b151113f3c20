#include "coupler/scene/schema.hpp"

#include "coupler/scene/embedded.hpp"

namespace gabion::scene {

const std::string& schema_text() {
  static const std::string text = embedded::schema;
  return text;
}

const Json& schema() {
  static const Json parsed = Json::parse(schema_text());
  return parsed;
}

std::optional<std::string> builtin_material(const std::string& name) {
  for (const embedded::Text& material : embedded::materials())
    if (name == material.name) return material.text;
  return std::nullopt;
}

std::vector<std::string> builtin_materials() {
  std::vector<std::string> names;
  for (const embedded::Text& material : embedded::materials()) names.emplace_back(material.name);
  return names;
}

}  // namespace gabion::scene
