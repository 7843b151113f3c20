#include <catch2/catch.hpp>
#include <cstring>
#include <vector>

#include "protocol/wire/frame.hpp"

using namespace gabion::protocol;

namespace {

constexpr std::uint64_t limit = 1 << 20;

std::vector<std::byte> frame_of(std::span<const std::byte> payload) {
  const HeaderBytes header = encode_header({.type = 71, .sequence = 5, .step = 1234}, {&payload, 1});
  std::vector<std::byte> bytes(header.size() + payload.size());
  std::copy(payload.begin(), payload.end(), std::copy(header.begin(), header.end(), bytes.begin()));
  return bytes;
}

/// Reads a frame as a connection would; throws FrameError.
FrameHeader read(std::span<const std::byte> bytes) {
  const auto head = bytes.first<FrameHeader::bytes>();
  const FrameHeader header = decode_header(head, limit);
  if (header.length != bytes.size() - FrameHeader::bytes) throw FrameError("the length is wrong");
  verify_checksum(head, bytes.subspan(FrameHeader::bytes));
  return header;
}

std::vector<std::byte> some_payload() {
  std::vector<std::byte> payload(100);
  for (std::size_t i = 0; i < payload.size(); ++i) payload[i] = static_cast<std::byte>(i * 37);
  return payload;
}

}  // namespace

TEST_CASE("a frame says what was put into it") {
  const FrameHeader header = read(frame_of(some_payload()));
  CHECK(header.type == 71);
  CHECK(header.length == 100);
  CHECK(header.sequence == 5);
  CHECK(header.step == 1234);
}

TEST_CASE("the bytes of a frame are those of the worked example in PROTOCOL.md") {
  // BYE, frame number 7, step 0; the checksum was computed with Python's zlib.
  const HeaderBytes header = encode_header({.type = 6, .sequence = 7, .step = 0}, {});
  const unsigned char expected[] = {0x47, 0x41, 0x42, 0x4e, 0x02, 0x00, 0x06, 0x00, 0,    0,    0,    0,
                                    0,    0,    0,    0,    0x07, 0,    0,    0,    0,    0,    0,    0,
                                    0,    0,    0,    0,    0,    0,    0,    0,    0x04, 0xd0, 0xfc, 0xaa};
  CHECK(std::memcmp(header.data(), expected, sizeof expected) == 0);
}

TEST_CASE("any single flipped bit is found") {
  const std::vector<std::byte> sound = frame_of(some_payload());
  for (std::size_t bit = 0; bit < 8 * sound.size(); ++bit) {
    std::vector<std::byte> changed = sound;
    changed[bit / 8] ^= static_cast<std::byte>(1 << (bit % 8));
    INFO("bit " << bit);
    REQUIRE_THROWS_AS(read(changed), FrameError);
  }
}

TEST_CASE("any two exchanged bytes are found") {
  const std::vector<std::byte> sound = frame_of(some_payload());
  for (std::size_t i = 0; i + 1 < sound.size(); ++i) {
    std::vector<std::byte> changed = sound;
    std::swap(changed[i], changed[i + 1]);
    if (changed == sound) continue;
    INFO("byte " << i);
    REQUIRE_THROWS_AS(read(changed), FrameError);
  }
}

TEST_CASE("another version, another protocol and an oversized payload have their own messages") {
  std::vector<std::byte> bytes = frame_of({});
  bytes[4] = std::byte{9};
  CHECK_THROWS_AS(read(bytes), VersionError);
  CHECK_THROWS_WITH(read(bytes), "the other side speaks version 9 of the protocol, this one 2");
  bytes = frame_of({});
  std::memcpy(bytes.data(), "HTTP", 4);
  CHECK_THROWS_WITH(read(bytes), Catch::Contains("do not start with GABN"));
  bytes = frame_of({});
  bytes[8 + 5] = std::byte{1};
  CHECK_THROWS_WITH(read(bytes), "a payload of 1099511627776 bytes is above the limit of 1048576");
}

TEST_CASE("the checksum does not depend on how the payload was cut into parts") {
  const std::vector<std::byte> payload = some_payload();
  const std::span<const std::byte> all(payload);
  const std::span<const std::byte> parts[] = {all.first(1), all.subspan(1, 0), all.subspan(1)};
  const HeaderBytes whole = encode_header({.type = 1}, {&all, 1});
  CHECK(whole == encode_header({.type = 1}, parts));
}
