#include "coupler/scene/read_scene.hpp"

#include "coupler/scene/build.hpp"
#include "coupler/scene/checks.hpp"
#include "coupler/scene/document.hpp"
#include "coupler/scene/materials.hpp"
#include "coupler/scene/schema.hpp"

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
void resolve_paths(Json& values, const std::filesystem::path& folder, std::vector<SceneProblem>& problems) {
  if (!values["initial"].contains("state")) return;
  Json& path = values["initial"]["state"];
  const std::filesystem::path resolved = std::filesystem::absolute(folder / path.get<std::string>()).lexically_normal();
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
