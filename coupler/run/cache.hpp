#pragma once
// Files that spare a run what an earlier one has computed. Each is one protocol payload with a checksum; a damaged file
// is ignored and replaced.

#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <optional>
#include <span>
#include <string>
#include <vector>
#include <zlib.h>

#include "protocol/wire/codec.hpp"

namespace gabion::coupler {

class Cache {
 public:
  /// Folder: GABION_CACHE, else XDG_CACHE_HOME/gabion, else ~/.cache/gabion.
  Cache();
  std::filesystem::path file(const std::string& kind, std::uint64_t key) const;

 private:
  std::filesystem::path folder_;
};

template <class Message>
std::optional<Message> read_cached(const std::filesystem::path& path) {
  std::ifstream in(path, std::ios::binary);
  if (!in) return std::nullopt;
  std::vector<char> bytes((std::istreambuf_iterator<char>(in)), {});
  std::uint32_t crc = 0;
  if (bytes.size() < sizeof crc) return std::nullopt;
  std::memcpy(&crc, bytes.data(), sizeof crc);
  const std::span<const std::byte> payload(reinterpret_cast<const std::byte*>(bytes.data()) + sizeof crc, bytes.size() - sizeof crc);
  if (crc32(0, reinterpret_cast<const Bytef*>(payload.data()), static_cast<uInt>(payload.size())) != crc) return std::nullopt;
  try {
    protocol::Reader reader(payload);
    Message message;
    message.decode(reader);
    return message;
  } catch (const protocol::CodecError&) {
    return std::nullopt;
  }
}

/// Best effort: a cache that cannot be written costs time, not the run.
template <class Message>
void write_cached(const std::filesystem::path& path, const Message& message) {
  std::vector<std::byte> payload;
  protocol::Writer writer(payload);
  message.encode(writer);
  const std::uint32_t crc = static_cast<std::uint32_t>(
      crc32(0, reinterpret_cast<const Bytef*>(payload.data()), static_cast<uInt>(payload.size())));
  std::error_code error;
  std::filesystem::create_directories(path.parent_path(), error);
  std::filesystem::path unfinished = path;
  unfinished += ".";
  unfinished += std::to_string(std::hash<std::string>{}(path.string()) ^ static_cast<std::size_t>(std::rand()));
  {
    std::ofstream out(unfinished, std::ios::binary);
    out.write(reinterpret_cast<const char*>(&crc), sizeof crc);
    out.write(reinterpret_cast<const char*>(payload.data()), static_cast<std::streamsize>(payload.size()));
    if (!out) return;
  }
  std::filesystem::rename(unfinished, path, error);
}

}  // namespace gabion::coupler
