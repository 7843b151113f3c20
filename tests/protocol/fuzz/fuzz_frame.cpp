// libFuzzer target: any bytes as a frame, any payload as any message. What decodes must encode again to a
// payload that decodes to the same bytes.

#include <cstdlib>

#include "protocol/messages.hpp"
#include "protocol/wire/frame.hpp"

using namespace gabion::protocol;

namespace {

template <class M>
void try_message(std::span<const std::byte> payload) {
  M message;
  try {
    Reader reader(payload);
    message.decode(reader);
  } catch (const CodecError&) {
    return;
  }
  std::vector<std::byte> again;
  Writer writer(again);
  message.encode(writer);
  if (!std::equal(again.begin(), again.end(), payload.begin(), payload.end())) std::abort();
}

template <class... M>
void try_type(std::uint16_t type, std::span<const std::byte> payload, std::tuple<M...>*) {
  ((M::id == type ? try_message<M>(payload) : void()), ...);
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::span<const std::byte> bytes(reinterpret_cast<const std::byte*>(data), size);
  // The bytes as a whole frame; its checksum will hardly ever fit.
  if (size >= FrameHeader::bytes) {
    const auto head = bytes.first<FrameHeader::bytes>();
    try {
      const FrameHeader header = decode_header(head, 1 << 20);
      if (header.length <= size - FrameHeader::bytes)
        verify_checksum(head, bytes.subspan(FrameHeader::bytes, header.length));
    } catch (const FrameError&) {
    }
  }
  // The first byte as a type, the rest as its payload: past the checksum, as a hostile client would be.
  if (size >= 1)
    try_type(std::to_integer<std::uint16_t>(bytes[0]), bytes.subspan(1), static_cast<AllMessages*>(nullptr));
  return 0;
}
