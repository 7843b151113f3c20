#pragma once
// What is wrong with a scene, told to the user.

#include <stdexcept>
#include <string>
#include <vector>

namespace gabion::scene {

/// One mistake. Text form: "path: value, expected ...; advice".
struct SceneProblem {
  std::string path;      ///< key path, such as grains.radius.uniform[1]; empty: the file as a whole
  std::string value;     ///< what was found there, or "missing", "unknown key"
  std::string expected;  ///< may be empty
  std::string advice;    ///< what to do; may be empty

  std::string text() const;
};

/// All problems found in one reading. what() lists the first ten, one a line, each with the file's name.
class SceneError : public std::runtime_error {
 public:
  SceneError(std::string file, std::vector<SceneProblem> problems);

  const std::string& file() const { return file_; }
  const std::vector<SceneProblem>& problems() const { return problems_; }

 private:
  std::string file_;
  std::vector<SceneProblem> problems_;
};

/// The known word with the smallest edit distance (insertion, deletion, exchange, swap of neighbours);
/// empty when none is near enough to be meant.
std::string nearest(const std::string& word, const std::vector<std::string>& known);

/// "'word'"
std::string quoted(const std::string& word);

/// "a, b, c"
std::string listed(const std::vector<std::string>& words);

/// "did you mean 'x'? known here: a, b, c"; without the question when nothing is near.
std::string suggestion(const std::string& word, const std::vector<std::string>& known);

}  // namespace gabion::scene
