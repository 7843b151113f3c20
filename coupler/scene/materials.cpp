#include "coupler/scene/materials.hpp"

#include <algorithm>

#include "coupler/scene/schema.hpp"

namespace gabion::scene {
namespace {

namespace fs = std::filesystem;

std::vector<std::string> known_names(const Json& inline_materials, const fs::path& folder) {
  std::vector<std::string> names = builtin_materials();
  for (const auto& item : inline_materials.items()) names.push_back(item.key());
  std::error_code none;
  for (const fs::directory_entry& file : fs::directory_iterator(folder, none))
    if (file.path().extension() == ".json") names.push_back(file.path().stem().string());
  std::sort(names.begin(), names.end());
  names.erase(std::unique(names.begin(), names.end()), names.end());
  return names;
}

/// A material from its text; problems are told with the file's name.
Json parse_material(const std::string& text, const std::string& file, std::vector<SceneProblem>& problems) {
  std::vector<SceneProblem> own;
  const Json material = parse_document(text, own);
  if (own.empty()) read_by_schema(material, own, "material");
  for (SceneProblem& problem : own) {
    problem.path = file + (problem.path.empty() ? "" : ": " + problem.path);
    problems.push_back(problem);
  }
  return material;
}

Json find_material(const std::string& name, const Json& inline_materials, const fs::path& folder,
                   const std::string& user, std::vector<SceneProblem>& problems) {
  if (inline_materials.contains(name)) return inline_materials[name];
  const fs::path file = folder / (name + ".json");
  const bool is_name = name.find_first_of("/\\") == std::string::npos && !name.empty();
  if (is_name && fs::exists(file)) return parse_material(read_text(file), file.string(), problems);
  if (const auto text = builtin_material(name)) return parse_material(*text, "built-in material " + name, problems);
  problems.push_back({user, quoted(name), "the name of a material",
                      suggestion(name, known_names(inline_materials, folder)) +
                          "; define it under 'materials' or in materials/" + name + ".json beside the scene"});
  return nullptr;
}

}  // namespace

void resolve_materials(Json& document, const fs::path& folder, std::vector<SceneProblem>& problems) {
  const Json given = document.value("materials", Json::object());
  Json used = Json::object();
  const auto use = [&](const std::string& name, const std::string& user) {
    if (used.contains(name)) return;
    const Json material = find_material(name, given, folder / "materials", user, problems);
    if (!material.is_null()) used[name] = material;
  };
  use(document["ground"]["material"], "ground.material");
  const Json fills = document.value("fills", Json::array());
  for (std::size_t i = 0; i < fills.size(); ++i) use(fills[i]["material"], "fills[" + std::to_string(i) + "].material");
  document["materials"] = used;
}

void resolve_coupling(Json& document) {
  const std::string model = document["model"];
  Json coupling = document.value("coupling", Json::object());
  const Json own = coupling.value(model, Json::object());
  coupling.erase("bridging");
  coupling.erase("edge");
  coupling.update(own);
  if (model != "bridging" && model != "edge") {
    document.erase("coupling");
    return;
  }
  if (!coupling.contains("rows")) coupling["rows"] = model == "edge" ? "edge" : "mortar";
  document["coupling"] = coupling;
}

}  // namespace gabion::scene
