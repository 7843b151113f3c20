#pragma once
// The one folder a run writes to. docs/results.md lists what ends up in it.

#include <chrono>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>
#include <vector>

#include "coupler/results/history.hpp"

namespace gabion::coupler {

class RunFolder {
 public:
  enum class Existing {
    refuse,   ///< a folder that already holds something is a mistake
    replace,  ///< an earlier run's files are removed; any other file makes it a mistake all the same
  };

  /// Creates the folder, with parents. Logs of the engines, which the launcher may have opened already, do not
  /// count as content. Throws RunFolderError with path, what is in the way and what to do.
  explicit RunFolder(std::filesystem::path path, Existing existing = Existing::refuse);

  const std::filesystem::path& path() const { return path_; }
  std::filesystem::path file(std::string_view name) const { return path_ / name; }

  /// Replaces a file in one go: a reader sees the old content or the new, never a part. Throws ResultsError.
  void write_text(std::string_view name, std::string_view content) const;
  /// The same with keys in alphabetical order and numbers in their shortest exact form; nan and inf become null.
  void write_json(std::string_view name, const nlohmann::json& content) const;

  History history(std::string_view name, std::vector<std::string> columns) const {
    return History(file(name), std::move(columns));
  }

  /// Removes what the coupler has written, and the folder when nothing else is in it.
  void abandon();

  /// One line in run.log, with the seconds since the folder was opened; on disk when this returns.
  void log(std::string_view message);

 private:
  std::filesystem::path path_;
  std::ofstream log_;
  std::chrono::steady_clock::time_point opened_ = std::chrono::steady_clock::now();
};

/// What RunFolder::write_text does, for any path.
void write_atomically(const std::filesystem::path& path, std::string_view content);

}  // namespace gabion::coupler
