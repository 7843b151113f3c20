#pragma once
// What a schema cannot say: values that must fit one another.

#include <string>
#include <vector>

#include "coupler/scene/document.hpp"
#include "coupler/scene/problem.hpp"
#include "coupler/scene/scene.hpp"

namespace gabion::scene {

class Checker {
 public:
  /// document: as the user wrote it; effective: with defaults. Both only to show values in messages.
  Checker(const Scene& checked, const Json& document, const Json& effective)
      : scene(checked), document_(document), effective_(effective) {}

  void error(const std::string& path, const std::string& expected, const std::string& advice) {
    problems.push_back({path, found(path), expected, advice});
  }
  void warn(const std::string& path, const std::string& expected, const std::string& advice) {
    warnings.push_back({path, found(path), expected, advice});
  }

  bool given(const std::string& path) const { return find_path(document_, path) != nullptr; }
  /// The value as the user wrote it, else the default, else "missing".
  std::string found(const std::string& path) const;
  /// Where the user gave a key of the coupling: coupling.KEY, or coupling.MODEL.KEY.
  std::string coupling_path(const std::string& key) const;
  std::string zone_path() const;

  bool has_grains() const { return scene.model != Model::continuum; }
  bool has_mesh() const { return scene.model != Model::dem; }
  bool coupled() const { return has_grains() && has_mesh(); }

  const Scene& scene;
  std::vector<SceneProblem> problems, warnings;

 private:
  const Json& document_;
  const Json& effective_;
};

/// Boxes, sizes and places.
void check_space(Checker& checker);
/// Options, materials, faces and stages.
void check_choices(Checker& checker);

}  // namespace gabion::scene
