#include "coupler/scene/document.hpp"

#include <charconv>
#include <fstream>
#include <optional>
#include <set>
#include <sstream>

namespace gabion::scene {
namespace {

std::optional<std::size_t> as_index(const std::string& step) {
  std::size_t index = 0;
  const auto [end, error] = std::from_chars(step.data(), step.data() + step.size(), index);
  if (step.empty() || error != std::errc{} || end != step.data() + step.size()) return std::nullopt;
  return index;
}

/// "a.b[2].c" and "a.b.2.c" give a, b, 2, c; empty when the path is malformed.
std::vector<std::string> split_path(const std::string& path) {
  std::vector<std::string> steps;
  std::string step;
  const auto finish = [&](bool may_be_empty) {
    if (step.empty() && !may_be_empty) return false;
    if (!step.empty()) steps.push_back(step);
    step.clear();
    return true;
  };
  for (std::size_t i = 0; i < path.size(); ++i) {
    const bool after_index = i > 0 && path[i - 1] == ']';
    if (path[i] == '.') {
      if (!finish(after_index)) return {};
    } else if (path[i] == '[') {
      if (!finish(after_index)) return {};
      const auto close = path.find(']', i);
      if (close == std::string::npos || !as_index(path.substr(i + 1, close - i - 1))) return {};
      steps.push_back(path.substr(i + 1, close - i - 1));
      i = close;
    } else {
      step += path[i];
    }
  }
  if (!finish(!path.empty() && path.back() == ']')) return {};
  return steps;
}

std::string joined(const std::vector<std::string>& steps, std::size_t count) {
  std::string path;
  for (std::size_t i = 0; i < count; ++i) path += (i ? "." : "") + steps[i];
  return path;
}

/// The place that the steps lead to, made where it is missing; nullptr after a problem.
Json* reach(Json& document, const std::vector<std::string>& steps, const std::string& text,
            std::vector<SceneProblem>& problems) {
  Json* place = &document;
  for (std::size_t i = 0; i < steps.size(); ++i) {
    const auto index = as_index(steps[i]);
    if (place->is_null()) *place = index ? Json::array() : Json::object();
    if (place->is_array() && index && *index <= place->size()) {
      if (*index == place->size()) place->push_back(nullptr);
      place = &(*place)[*index];
    } else if (place->is_object()) {
      place = &(*place)[steps[i]];
    } else {
      const std::string where = joined(steps, i);
      const std::string expected =
          place->is_array() ? "an index from 0 to " + std::to_string(place->size()) + " after '" + where + "'"
                            : "nothing below '" + where + "', which is " + place->dump();
      problems.push_back({where, "--set " + text, expected, "set '" + where + "' as a whole, or correct the path"});
      return nullptr;
    }
  }
  return place;
}

bool is_utf8(const std::string& text) {
  try {
    (void)Json(text).dump();
    return true;
  } catch (const Json::type_error&) {
    return false;
  }
}

void remove_nulls(Json& value) {
  if (value.is_object()) {
    for (auto item = value.begin(); item != value.end();) {
      if (item->is_null()) {
        item = value.erase(item);
      } else {
        remove_nulls(*item);
        ++item;
      }
    }
  } else if (value.is_array()) {
    for (std::size_t i = value.size(); i-- > 0;) {
      if (value[i].is_null())
        value.erase(i);
      else
        remove_nulls(value[i]);
    }
  }
}

}  // namespace

std::string read_text(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  std::ostringstream text;
  if (file) text << file.rdbuf();
  if (!file || std::filesystem::is_directory(path))
    throw SceneError(path.string(), {{"", "cannot be read", "", "check the name and the permissions of the file"}});
  return text.str();
}

Json parse_document(const std::string& text, std::vector<SceneProblem>& problems) {
  // nlohmann keeps the last of two equal keys without a word: watch the keys of each open object
  std::vector<std::set<std::string>> open;
  const auto watch = [&](int, Json::parse_event_t event, Json& parsed) {
    if (event == Json::parse_event_t::object_start) open.emplace_back();
    if (event == Json::parse_event_t::object_end) open.pop_back();
    if (event == Json::parse_event_t::key && !open.back().insert(parsed.get<std::string>()).second)
      problems.push_back(
          {parsed.get<std::string>(), "the key is given twice", "each key once", "remove one of the two"});
    return true;
  };
  try {
    Json document = Json::parse(text, watch, true, true);
    if (!document.is_object() && problems.empty())
      problems.push_back({"", document.dump().substr(0, 40), "an object: { \"gabion\": 1, ... }", ""});
    return document;
  } catch (const Json::exception& error) {  // syntax, encoding, a number out of range
    std::string what = error.what();  // "[json.exception.parse_error.101] parse error at line 3, column 5: ..."
    if (const auto bracket = what.find("] "); bracket != std::string::npos) what = what.substr(bracket + 2);
    problems.push_back({"", what, "JSON; // and /* */ comments are allowed",
                        "look for a missing comma, quote or bracket before that place"});
    return {};
  }
}

void apply_override(Json& document, const std::string& text, std::vector<SceneProblem>& problems) {
  if (!is_utf8(text)) {
    problems.push_back({"--set", "text with bytes that are no UTF-8", "UTF-8", "check the encoding of the terminal or script"});
    return;
  }
  const auto equals = text.find('=');
  const auto steps = equals == std::string::npos ? std::vector<std::string>{} : split_path(text.substr(0, equals));
  if (steps.empty()) {
    problems.push_back(
        {"--set", quoted(text), "key.path=value", "such as --set model=dem or --set stages[0].damping=0.69"});
    return;
  }
  const std::string value_text = text.substr(equals + 1);
  Json value = Json::parse(value_text, nullptr, false);
  if (value.is_discarded()) value = value_text;
  Json* place = reach(document, steps, text, problems);
  if (place == nullptr) return;
  *place = value;
  remove_nulls(document);
}

const Json* find_path(const Json& document, const std::string& path) {
  const auto steps = split_path(path);
  const Json* place = &document;
  for (const std::string& step : steps) {
    const auto index = as_index(step);
    if (place->is_object() && place->contains(step))
      place = &(*place)[step];
    else if (place->is_array() && index && *index < place->size())
      place = &(*place)[*index];
    else
      return nullptr;
  }
  return steps.empty() ? nullptr : place;
}

}  // namespace gabion::scene
