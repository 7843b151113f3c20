#include "coupler/results/run_folder.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstdio>
#include <cstring>

#include "coupler/results/errors.hpp"

namespace gabion::coupler {

namespace fs = std::filesystem;

namespace {

constexpr std::array launcher_logs = {"dem_server.log", "continuum_server.log", "coupler.log"};

// Names and endings of what runs and their reports write. Nothing else is ever removed.
constexpr std::array run_files = {"summary.json", "scene.effective.json", "run.log", "results.h5", "results.xdmf",
                                  "grains.vtkhdf", "mesh.vtkhdf", "report.html", "checkpoint",
                                  "laboratory.json", "zone.json"};
constexpr std::array run_endings = {".csv", ".png", ".tmp"};

template <std::size_t n>
bool one_of(const std::array<const char*, n>& names, const std::string& name) {
  for (const char* candidate : names)
    if (name == candidate) return true;
  return false;
}

bool written_by_a_run(const fs::path& path) {
  return one_of(run_files, path.filename().string()) || one_of(run_endings, path.extension().string()) ||
         path.filename() == "plots";
}

std::string system_error(const fs::path& path, const char* what) {
  return path.string() + ": " + what + ": " + std::strerror(errno);
}

void remove_own_files(const fs::path& folder) {
  for (const auto& entry : fs::directory_iterator(folder))
    if (written_by_a_run(entry.path())) fs::remove_all(entry.path());
}

void remove_earlier_run(const fs::path& folder) {
  for (const auto& entry : fs::directory_iterator(folder)) {
    const std::string name = entry.path().filename().string();
    if (!one_of(launcher_logs, name) && !written_by_a_run(entry.path()))
      throw RunFolderError("run folder " + folder.string() + " holds '" + name +
                           "', which no run has written; nothing was removed. Choose another --out");
  }
  remove_own_files(folder);
}

void refuse_content(const fs::path& folder) {
  for (const auto& entry : fs::directory_iterator(folder)) {
    const std::string name = entry.path().filename().string();
    if (!one_of(launcher_logs, name))
      throw RunFolderError("run folder " + folder.string() + " is not empty (it holds '" + name +
                           "'). Choose another --out, or say --overwrite to replace an earlier run");
  }
}

}  // namespace

RunFolder::RunFolder(fs::path path, Existing existing) : path_(std::move(path)) {
  try {
    if (fs::exists(path_) && !fs::is_directory(path_))
      throw RunFolderError("run folder " + path_.string() + " is a file. Choose another --out");
    fs::create_directories(path_);
    existing == Existing::replace ? remove_earlier_run(path_) : refuse_content(path_);
  } catch (const fs::filesystem_error& error) {
    throw RunFolderError("run folder " + path_.string() + " cannot be used: " + error.code().message());
  }
  log_.open(file("run.log"), std::ios::binary | std::ios::trunc);
  if (!log_) throw RunFolderError(system_error(file("run.log"), "cannot be written"));
}

void RunFolder::write_text(std::string_view name, std::string_view content) const {
  write_atomically(file(name), content);
}

void RunFolder::write_json(std::string_view name, const nlohmann::json& content) const {
  constexpr int indent = 2;
  write_text(name, content.dump(indent, ' ', false, nlohmann::json::error_handler_t::replace) + "\n");
}

void RunFolder::abandon() {
  log_.close();
  remove_own_files(path_);
  std::error_code not_empty;
  fs::remove(path_, not_empty);
}

void RunFolder::log(std::string_view message) {
  constexpr std::size_t stamp_length = 32;
  char stamp[stamp_length];
  const std::chrono::duration<double> elapsed = std::chrono::steady_clock::now() - opened_;
  std::snprintf(stamp, sizeof stamp, "%10.3f s  ", elapsed.count());
  log_ << stamp << message << '\n' << std::flush;
}

void write_atomically(const fs::path& path, std::string_view content) {
  fs::path draft = path;
  draft += ".tmp";
  const int file = ::open(draft.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0644);
  if (file < 0) throw ResultsError(system_error(draft, "cannot be created"));
  std::size_t done = 0;
  while (done < content.size()) {
    const ssize_t count = ::write(file, content.data() + done, content.size() - done);
    if (count < 0 && errno == EINTR) continue;
    if (count < 0) {
      const std::string message = system_error(draft, "cannot be written");
      ::close(file);
      ::unlink(draft.c_str());
      throw ResultsError(message);
    }
    done += static_cast<std::size_t>(count);
  }
  // The content must be on the disk before the name points to it, or a power cut leaves an empty file.
  const bool synced = ::fsync(file) == 0 || errno == EINVAL;
  if (::close(file) != 0 || !synced) throw ResultsError(system_error(draft, "cannot be written"));
  if (::rename(draft.c_str(), path.c_str()) != 0) throw ResultsError(system_error(path, "cannot be replaced"));
}

}  // namespace gabion::coupler
