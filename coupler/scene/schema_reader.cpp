// read_by_schema: one recursive walk along document and schema.

#include <algorithm>
#include <cmath>

#include "coupler/scene/schema.hpp"
#include "coupler/scene/schema_node.hpp"
#include "coupler/scene/units.hpp"

namespace gabion::scene {
namespace {

constexpr std::size_t longest_value = 60;

std::string shown(const Json& value) {
  const std::string text = value.is_string() ? quoted(value) : value.dump();
  return text.size() <= longest_value ? text : text.substr(0, longest_value) + " ...";
}

std::string below(const std::string& path, const std::string& key) {
  return path.empty() ? key : path + "." + key;
}

std::string below(const std::string& path, std::size_t index) {
  return path + "[" + std::to_string(index) + "]";
}

std::string example_of(const Json& node) {
  if (node.contains("examples")) return ", such as " + node["examples"].front().dump();
  return "";
}

/// "above 0 m and at most 3 m"
std::string range_of(const Json& node) {
  const std::string unit = node.value("unit", "1");
  struct Bound {
    const char *key, *words;
  };
  static constexpr Bound bounds[] = {{"minimum", "at least "},
                                     {"exclusiveMinimum", "above "},
                                     {"maximum", "at most "},
                                     {"exclusiveMaximum", "below "}};
  std::string text;
  for (const Bound& bound : bounds)
    if (node.contains(bound.key))
      text += (text.empty() ? "" : " and ") + std::string(bound.words) +
              format_quantity(node[bound.key].get<double>(), unit);
  return text;
}

bool in_range(double value, const Json& node) {
  const auto limit = [&](const char* key) { return node[key].get<double>(); };
  return !(node.contains("minimum") && value < limit("minimum")) &&
         !(node.contains("exclusiveMinimum") && value <= limit("exclusiveMinimum")) &&
         !(node.contains("maximum") && value > limit("maximum")) &&
         !(node.contains("exclusiveMaximum") && value >= limit("exclusiveMaximum"));
}

class Reader {
 public:
  explicit Reader(std::vector<SceneProblem>& problems) : problems_(problems) {}

  Json read(const Json& value, const Json& raw_node, const std::string& path) {
    const Json node = resolved(raw_node);
    if (node.contains("anyOf")) return read_alternative(value, node, path);
    if (node.contains("unit")) return read_quantity(value, node, path);
    if (node.contains("enum")) return read_choice(value, node, path);
    const std::string type = node.at("type");
    if (!has_type(value, type)) return wrong_type(value, node, path);
    if (type == "object") return read_object(value, node, path);
    if (type == "array") return read_array(value, node, path);
    if (type == "integer") check_range(value, value.get<double>(), node, path);
    return value;
  }

 private:
  Json fail(const std::string& path, std::string value, std::string expected, std::string advice = "") {
    problems_.push_back({path, std::move(value), std::move(expected), std::move(advice)});
    return nullptr;
  }

  Json wrong_type(const Json& value, const Json& node, const std::string& path) {
    return fail(path, shown(value), type_phrase(node) + example_of(node), node.value("description", ""));
  }

  void check_range(const Json& value, double number, const Json& node, const std::string& path) {
    if (!in_range(number, node)) fail(path, shown(value), range_of(node), node.value("advice", ""));
  }

  Json read_quantity(const Json& value, const Json& node, const std::string& path) {
    const std::string unit = node["unit"];
    const bool may_be_infinite = node.value("infinite", false);
    const std::string expected = describe_unit(unit) + (may_be_infinite ? ", or 'infinite'" : "");
    if (value.is_number()) return read_bare_number(value, node, path, expected);
    if (!value.is_string()) return fail(path, shown(value), expected, node.value("description", ""));
    const std::string text = value;
    if (means_infinite(text)) {
      if (may_be_infinite) return INFINITY;
      return fail(path, shown(value), expected, "it must be finite");
    }
    try {
      const Quantity quantity = parse_quantity(text);
      const bool fits =
          quantity.dimension == parse_unit(unit) || (quantity.value == 0.0 && quantity.dimension == Dimension{});
      if (!fits && quantity.dimension == Dimension{})
        return fail(path, shown(value), expected, "write the unit behind the number");
      if (!fits) return fail(path, shown(value), expected, "the unit measures something else");
      check_range(value, quantity.value, node, path);
      return quantity.value;
    } catch (const UnitError& error) {
      return fail(path, shown(value), expected, error.what());
    }
  }

  Json read_bare_number(const Json& value, const Json& node, const std::string& path, const std::string& expected) {
    const double number = value;
    if (node["unit"] != "1" && number != 0.0 && std::isfinite(number))
      return fail(path, shown(value), expected,
                  "write the unit behind the number, " + quoted(value.dump() + " " + node["unit"].get<std::string>()));
    check_range(value, number, node, path);
    return number + 0.0;
  }

  Json read_choice(const Json& value, const Json& node, const std::string& path) {
    const Json& choices = node["enum"];
    if (std::find(choices.begin(), choices.end(), value) != choices.end()) return value;
    const std::vector<std::string> words = choice_words(node);
    const std::string near = value.is_string() ? nearest(value, words) : "";
    return fail(path, shown(value), (words.size() > 1 ? "one of " : "") + listed(words),
                near.empty() ? node.value("description", "") : "did you mean " + quoted(near) + "?");
  }

  Json read_array(const Json& value, const Json& node, const std::string& path) {
    const std::size_t least = node.value("minItems", std::size_t{0}), most = node.value("maxItems", value.size());
    if (value.size() < least || value.size() > most) {
      const std::string count = least == most          ? std::to_string(least)
                                : most == value.size() ? "at least " + std::to_string(least)
                                                       : std::to_string(least) + " to " + std::to_string(most);
      return fail(path, "a list of " + std::to_string(value.size()), count + " items" + example_of(node),
                  node.value("description", ""));
    }
    Json result = Json::array();
    for (std::size_t i = 0; i < value.size(); ++i) result.push_back(read(value[i], item_node(node, i), below(path, i)));
    return result;
  }

  Json read_object(const Json& value, const Json& node, const std::string& path) {
    if (!node.contains("additionalProperties")) return value;  // free form
    static const Json nothing = Json::object();
    const Json& properties = node.contains("properties") ? node["properties"] : nothing;
    Json result = Json::object();
    for (const auto& [key, item] : value.items()) {
      if (const Json* known = property_node(node, key))
        result[key] = read(item, *known, below(path, key));
      else
        fail(below(path, key), "unknown key", "", suggestion(key, property_names(node)));
    }
    for (const Json& key : node.value("required", Json::array()))
      if (!value.contains(key)) missing(key, properties.at(key.get<std::string>()), path);
    for (const auto& [key, raw_property] : properties.items()) {
      if (value.contains(key)) continue;
      const Json property = resolved(raw_property);
      if (property.contains("default")) result[key] = read(property["default"], property, below(path, key));
    }
    return result;
  }

  void missing(const std::string& key, const Json& raw_property, const std::string& path) {
    const Json property = resolved(raw_property);
    fail(below(path, key), "missing", type_phrase(property) + example_of(property), property.value("description", ""));
  }

  Json read_alternative(const Json& value, const Json& node, const std::string& path) {
    std::vector<std::string> keys;  // by which alternative objects are told apart
    if (const Json* chosen = choose_alternative(value, node, keys)) {
      Json alternative = resolved(*chosen);
      if (!alternative.contains("description") && node.contains("description"))
        alternative["description"] = node["description"];
      return read(value, alternative, path);
    }
    if (!value.is_object() || keys.empty())
      return fail(path, shown(value), type_phrase(node) + example_of(node), node.value("description", ""));
    if (value.empty()) return fail(path, "{}", "one of the keys " + listed(keys) + example_of(node));
    const std::string first = value.begin().key();
    return fail(below(path, first), "unknown key", "", suggestion(first, keys));
  }

  std::vector<SceneProblem>& problems_;
};

}  // namespace

Json read_by_schema(const Json& document, std::vector<SceneProblem>& problems, const std::string& definition,
                    const std::string& path) {
  const Json& node = definition.empty() ? schema() : schema()["definitions"][definition];
  return Reader(problems).read(document, node, path);
}

}  // namespace gabion::scene
