#pragma once
// The 36 bytes in front of every message; PROTOCOL.md, "Frames", is the specification.

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <stdexcept>
#include <string>

namespace gabion::protocol {

/// Bytes that cannot be a frame of this protocol.
struct FrameError : std::runtime_error {
  using std::runtime_error::runtime_error;
};
/// A frame of another version of the protocol.
struct VersionError : FrameError {
  using FrameError::FrameError;
};

struct FrameHeader {
  static constexpr std::size_t bytes = 36;
  static constexpr std::size_t preamble_bytes = 8;  ///< magic, version and type: the same in every version
  static constexpr std::size_t checksum_offset = 32;

  std::uint16_t type = 0;      ///< id of the message
  std::uint64_t length = 0;    ///< bytes of payload
  std::uint64_t sequence = 0;  ///< 0, 1, 2 ... per direction of a connection
  std::uint64_t step = 0;      ///< time step the sender was at
  std::uint32_t checksum = 0;  ///< CRC-32 of header (with this field zero) and payload
};

using HeaderBytes = std::array<std::byte, FrameHeader::bytes>;

/// The header's bytes with the checksum over it and the parts of the payload, in order.
HeaderBytes encode_header(FrameHeader header, std::span<const std::span<const std::byte>> payload);

/// FrameError or VersionError when magic or version are wrong; to be known before the rest is waited for.
void check_preamble(std::span<const std::byte, FrameHeader::preamble_bytes> bytes);

/// Reads a header; FrameError or VersionError when magic, version or length (above limit) are wrong.
FrameHeader decode_header(std::span<const std::byte, FrameHeader::bytes> bytes, std::uint64_t payload_limit);

/// FrameError when the checksum is not that of these bytes.
void verify_checksum(std::span<const std::byte, FrameHeader::bytes> header, std::span<const std::byte> payload);

/// A received message; payload is valid until the connection receives again.
struct Frame {
  FrameHeader header;
  std::span<const std::byte> payload;
};

}  // namespace gabion::protocol
