#include "protocol/wire/frame.hpp"

#include <zlib.h>

#include <cstring>

#include "protocol/messages.hpp"

namespace gabion::protocol {

namespace {

constexpr std::array<char, 4> magic{'G', 'A', 'B', 'N'};

template <class T>
void store(HeaderBytes& bytes, std::size_t offset, T value) {
  std::memcpy(bytes.data() + offset, &value, sizeof value);
}

template <class T>
T load(std::span<const std::byte, FrameHeader::bytes> bytes, std::size_t offset) {
  T value;
  std::memcpy(&value, bytes.data() + offset, sizeof value);
  return value;
}

std::uint32_t add_to_checksum(std::uint32_t checksum, std::span<const std::byte> bytes) {
  // An empty span may carry a null pointer, which zlib takes as a request for the initial value.
  if (bytes.empty()) return checksum;
  return static_cast<std::uint32_t>(crc32_z(checksum, reinterpret_cast<const Bytef*>(bytes.data()), bytes.size()));
}

}  // namespace

HeaderBytes encode_header(FrameHeader header, std::span<const std::span<const std::byte>> payload) {
  header.length = 0;
  for (const auto part : payload) header.length += part.size();
  HeaderBytes bytes{};
  std::memcpy(bytes.data(), magic.data(), magic.size());
  store(bytes, 4, protocol_version);
  store(bytes, 6, header.type);
  store(bytes, 8, header.length);
  store(bytes, 16, header.sequence);
  store(bytes, 24, header.step);
  std::uint32_t checksum = add_to_checksum(0, bytes);
  for (const auto part : payload) checksum = add_to_checksum(checksum, part);
  store(bytes, FrameHeader::checksum_offset, checksum);
  return bytes;
}

void check_preamble(std::span<const std::byte, FrameHeader::preamble_bytes> bytes) {
  if (std::memcmp(bytes.data(), magic.data(), magic.size()) != 0)
    throw FrameError("the bytes do not start with GABN: the other side does not speak this protocol");
  std::uint16_t version;
  std::memcpy(&version, bytes.data() + magic.size(), sizeof version);
  if (version != protocol_version)
    throw VersionError("the other side speaks version " + std::to_string(version) + " of the protocol, this one " +
                       std::to_string(protocol_version));
}

FrameHeader decode_header(std::span<const std::byte, FrameHeader::bytes> bytes, std::uint64_t payload_limit) {
  check_preamble(bytes.first<FrameHeader::preamble_bytes>());
  const FrameHeader header{.type = load<std::uint16_t>(bytes, 6),
                           .length = load<std::uint64_t>(bytes, 8),
                           .sequence = load<std::uint64_t>(bytes, 16),
                           .step = load<std::uint64_t>(bytes, 24),
                           .checksum = load<std::uint32_t>(bytes, FrameHeader::checksum_offset)};
  if (header.length > payload_limit)
    throw FrameError("a payload of " + std::to_string(header.length) + " bytes is above the limit of " +
                     std::to_string(payload_limit));
  return header;
}

void verify_checksum(std::span<const std::byte, FrameHeader::bytes> header, std::span<const std::byte> payload) {
  HeaderBytes zeroed;
  std::memcpy(zeroed.data(), header.data(), header.size());
  store(zeroed, FrameHeader::checksum_offset, std::uint32_t{0});
  const std::uint32_t checksum = add_to_checksum(add_to_checksum(0, zeroed), payload);
  if (checksum != load<std::uint32_t>(header, FrameHeader::checksum_offset))
    throw FrameError("the checksum of a frame is wrong: its bytes were changed on the way");
}

}  // namespace gabion::protocol
