#pragma once
// An empty folder under the build folder, one a test.

#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>

inline std::filesystem::path fresh_folder(const std::string& name) {
  const std::filesystem::path folder = std::filesystem::path(GABION_BINARY_DIR) / "test_results" / name;
  std::filesystem::remove_all(folder);
  std::filesystem::create_directories(folder);
  return folder;
}

inline std::string content(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}
