#pragma once
// A run's state on disk: what the coupler knows, and what each engine gave as its own. CBOR, written in one go.

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>

namespace gabion::coupler {

constexpr const char* checkpoint_name = "checkpoint";

/// Replaces the file; a reader sees the old state or the new. Throws ResultsError.
void write_checkpoint(const std::filesystem::path& file, const nlohmann::json& state);

/// path: a checkpoint or a run folder that holds one. scene_hash: of the scene that is to go on. Throws RunFolderError
/// with what to do: no such file, not a checkpoint, another scene's.
nlohmann::json read_checkpoint(const std::filesystem::path& path, const std::string& scene_hash);

}  // namespace gabion::coupler
