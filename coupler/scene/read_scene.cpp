#include "coupler/scene/read_scene.hpp"

#include <algorithm>

#include "coupler/scene/build.hpp"
#include "coupler/scene/checks.hpp"
#include "coupler/scene/document.hpp"
#include "coupler/scene/materials.hpp"
#include "coupler/scene/origin.hpp"
#include "coupler/scene/packing_file.hpp"
#include "coupler/scene/schema.hpp"
#include "coupler/scene/units.hpp"

namespace gabion::scene {
namespace {

/// FNV-1a over bytes.
std::uint64_t hash_of(const std::string& text) {
  constexpr std::uint64_t offset = 0xcbf29ce484222325ull, prime = 0x100000001b3ull;
  std::uint64_t hash = offset;
  for (const char c : text) hash = (hash ^ static_cast<unsigned char>(c)) * prime;
  return hash;
}

std::uint64_t scene_hash(Json effective) {
  effective.erase("title");
  effective.erase("expected");
  effective["run"].erase("threads");
  effective["run"].erase("checkpoint_every");
  return hash_of(effective.dump());  // keys are sorted, numbers written in their shortest form
}

std::string hexadecimal(std::uint64_t number) {
  std::string text(16, '0');
  for (std::size_t i = text.size(); i-- > 0; number >>= 4) text[i] = "0123456789abcdef"[number & 15];
  return text;
}

/// A path in the scene counts from the scene's folder; the effective scene, which lies elsewhere, has it whole.
std::filesystem::path whole_path(const Json& path, const std::filesystem::path& folder) {
  return std::filesystem::absolute(folder / path.get<std::string>()).lexically_normal();
}

/// A packing from a file brings its own radii: grains.radius becomes their range.
void take_packing_file(Json& document, const std::filesystem::path& folder, std::vector<SceneProblem>& problems) {
  if (!document.is_object() || !document.contains("grains") || !document["grains"].is_object()) return;
  Json& grains = document["grains"];
  if (grains.value("packing", Json()) != "file") return;
  if (!grains.contains("file") || !grains["file"].is_string()) {
    problems.push_back({"grains.file", "missing", "a file with one grain a row, x y z radius in metres",
                        "name it relative to the scene's folder, or use packing = random"});
    return;
  }
  const std::filesystem::path path = whole_path(grains["file"], folder);
  try {
    const PackingFile packing = read_packing_file(path);
    const auto [smallest, largest] = std::minmax_element(packing.radius.begin(), packing.radius.end());
    grains["radius"] = {{"uniform", {format_quantity(*smallest, "m"), format_quantity(*largest, "m")}}};
    grains["file"] = path.string();
  } catch (const std::runtime_error& error) {
    problems.push_back({"grains.file", quoted(grains["file"].get<std::string>()),
                        "a file with one grain a row, x y z radius in metres", error.what()});
  }
}

void resolve_paths(Json& values, const std::filesystem::path& folder, std::vector<SceneProblem>& problems) {
  if (!values["initial"].contains("state")) return;
  Json& path = values["initial"]["state"];
  const std::filesystem::path resolved = whole_path(path, folder);
  std::error_code error;
  if (!std::filesystem::is_regular_file(resolved, error))
    problems.push_back({"initial.state", quoted(path.get<std::string>()), "the results.h5 of an earlier run",
                        "there is no file " + resolved.string()});
  path = resolved.string();
}

void stop_at(const std::string& file, const std::vector<SceneProblem>& problems) {
  if (!problems.empty()) throw SceneError(file, problems);
}

}  // namespace

ReadResult read_scene(const std::filesystem::path& file, const std::vector<std::string>& overrides) {
  return read_scene_text(read_text(file), file.string(), file.parent_path(), overrides);
}

ReadResult read_scene_text(const std::string& text, const std::string& label, const std::filesystem::path& folder,
                           const std::vector<std::string>& overrides) {
  std::vector<SceneProblem> problems;
  Json document = parse_document(text, problems);
  stop_at(label, problems);
  for (const std::string& override_text : overrides) apply_override(document, override_text, problems);
  stop_at(label, problems);
  take_packing_file(document, folder, problems);
  stop_at(label, problems);

  read_by_schema(document, problems);
  stop_at(label, problems);
  validate_structure(document, problems);
  stop_at(label, problems);

  Json resolved = document;
  resolve_materials(resolved, folder, problems);
  stop_at(label, problems);
  resolve_coupling(resolved);
  Json values = read_by_schema(resolved, problems);
  stop_at(label, problems);
  resolve_paths(values, folder, problems);
  stop_at(label, problems);

  ReadResult result;
  result.scene = build_scene(values, std::filesystem::path(label).stem().string());
  const Json effective = write_by_schema(values);
  count_from_origin(result.scene);
  Checker checker(result.scene, document, effective);
  check_space(checker);
  check_choices(checker);
  stop_at(label, checker.problems);

  result.effective = effective.dump(2) + "\n";
  result.hash = scene_hash(effective);
  result.hash_text = hexadecimal(result.hash);
  result.warnings = checker.warnings;
  return result;
}

}  // namespace gabion::scene
