#pragma once
// A packing given as a text file: one grain a row, "x y z radius" in metres, separated by blanks or commas; what follows
// a # is a comment. Positions are coordinates of the scene.

#include <filesystem>
#include <vector>

#include "coupler/scene/problem.hpp"
#include "coupler/scene/scene.hpp"

namespace gabion::scene {

struct PackingFile {
  std::vector<Point> position;  ///< m
  std::vector<double> radius;   ///< m
};

/// Throws std::runtime_error that names the row and what is wrong with it.
PackingFile read_packing_file(const std::filesystem::path& file);

}  // namespace gabion::scene
