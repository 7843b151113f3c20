// write_by_schema: SI numbers back to text with units.

#include "coupler/scene/schema.hpp"
#include "coupler/scene/schema_node.hpp"
#include "coupler/scene/units.hpp"

namespace gabion::scene {
namespace {

Json written(const Json& value, const Json& raw_node) {
  const Json node = resolved(raw_node);
  if (node.contains("anyOf")) {
    std::vector<std::string> keys;
    const Json* chosen = choose_alternative(value, node, keys);
    return chosen != nullptr ? written(value, *chosen) : value;
  }
  if (node.contains("unit")) {
    const std::string unit = node["unit"];
    const double number = value;
    const bool bare = unit == "1" && number <= std::numeric_limits<double>::max();
    return bare ? value : Json(format_quantity(number, unit));
  }
  if (value.is_array()) {
    Json result = Json::array();
    for (std::size_t i = 0; i < value.size(); ++i) result.push_back(written(value[i], item_node(node, i)));
    return result;
  }
  if (value.is_object() && node.contains("additionalProperties")) {
    Json result = Json::object();
    for (const auto& [key, item] : value.items()) result[key] = written(item, *property_node(node, key));
    return result;
  }
  return value;
}

}  // namespace

Json write_by_schema(const Json& values) {
  return written(values, schema());
}

}  // namespace gabion::scene
