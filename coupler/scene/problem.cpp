#include "coupler/scene/problem.hpp"

#include <algorithm>

namespace gabion::scene {
namespace {

constexpr std::size_t most_shown = 10;

std::string message(const std::string& file, const std::vector<SceneProblem>& problems) {
  std::string text;
  for (std::size_t i = 0; i < std::min(problems.size(), most_shown); ++i)
    text += (i ? "\n" : "") + file + ": " + problems[i].text();
  if (problems.size() > most_shown)
    text += "\n" + file + ": and " + std::to_string(problems.size() - most_shown) + " more";
  return text;
}

char lower(char c) {
  return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
}

/// Optimal string alignment distance, letters of either case alike.
std::size_t distance(const std::string& a, const std::string& b) {
  std::vector<std::vector<std::size_t>> d(a.size() + 1, std::vector<std::size_t>(b.size() + 1));
  for (std::size_t i = 0; i <= a.size(); ++i) d[i][0] = i;
  for (std::size_t j = 0; j <= b.size(); ++j) d[0][j] = j;
  for (std::size_t i = 1; i <= a.size(); ++i)
    for (std::size_t j = 1; j <= b.size(); ++j) {
      const std::size_t differs = lower(a[i - 1]) != lower(b[j - 1]);
      d[i][j] = std::min({d[i - 1][j] + 1, d[i][j - 1] + 1, d[i - 1][j - 1] + differs});
      const bool swapped = i > 1 && j > 1 && lower(a[i - 1]) == lower(b[j - 2]) && lower(a[i - 2]) == lower(b[j - 1]);
      if (swapped) d[i][j] = std::min(d[i][j], d[i - 2][j - 2] + 1);
    }
  return d[a.size()][b.size()];
}

}  // namespace

std::string SceneProblem::text() const {
  std::string line = path.empty() ? value : path + ": " + value;
  if (!expected.empty()) line += ", expected " + expected;
  if (!advice.empty()) line += "; " + advice;
  return line;
}

SceneError::SceneError(std::string file, std::vector<SceneProblem> problems)
    : std::runtime_error(message(file, problems)), file_(std::move(file)), problems_(std::move(problems)) {}

std::string nearest(const std::string& word, const std::vector<std::string>& known) {
  std::string best;
  std::size_t least = std::max<std::size_t>(2, word.size() / 3) + 1;
  for (const std::string& candidate : known) {
    std::size_t d = distance(word, candidate);
    // a word cut short, such as "grav", is meant even when the missing part is long
    if (word.size() >= 3 && candidate.compare(0, word.size(), word) == 0) d = std::min<std::size_t>(d, 2);
    if (d < least && d < candidate.size()) {
      least = d;
      best = candidate;
    }
  }
  return best;
}

std::string quoted(const std::string& word) {
  std::string text("'");
  text.append(word).append("'");
  return text;
}

std::string listed(const std::vector<std::string>& words) {
  std::string text;
  for (const std::string& word : words) text += (text.empty() ? "" : ", ") + word;
  return text;
}

std::string suggestion(const std::string& word, const std::vector<std::string>& known) {
  const std::string near = nearest(word, known);
  const std::string question = near.empty() ? "" : "did you mean " + quoted(near) + "? ";
  return question + (known.empty() ? "no keys are known here" : "known here: " + listed(known));
}

}  // namespace gabion::scene
