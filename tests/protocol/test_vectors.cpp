// Payloads that the reference client in Python made, one of every message.
#include <catch2/catch.hpp>
#include <fstream>
#include <nlohmann/json.hpp>

#include "protocol/wire/frame.hpp"
#include "random_message.hpp"

using namespace gabion::protocol;
using nlohmann::json;

namespace {

std::vector<std::byte> from_hex(const std::string& text) {
  std::vector<std::byte> bytes;
  for (std::size_t i = 0; i < text.size(); i += 2)
    bytes.push_back(static_cast<std::byte>(std::stoi(text.substr(i, 2), nullptr, 16)));
  return bytes;
}

template <class T>
bool same(const T& value, const json& expected) {
  return value == expected.get<T>();
}
template <class T>
bool same(const Array<T>& array, const json& expected) {
  const auto extents = array.extents();
  return std::vector<std::uint64_t>(extents.begin(), extents.end()) ==
             expected["shape"].get<std::vector<std::uint64_t>>() &&
         array.data == expected["values"].get<std::vector<T>>();
}

}  // namespace

TEST_CASE("what the reference client in Python sends is understood, and sent in the same bytes") {
  std::ifstream file(GABION_SOURCE_DIR "/tests/protocol/vectors.json");
  const json vectors = json::parse(file);
  REQUIRE(vectors.size() == std::tuple_size_v<AllMessages>);
  for_each_message([&]<class M>(M) {
    INFO(M::type_name);
    const auto example =
        std::find_if(vectors.begin(), vectors.end(), [](const json& e) { return e["message"] == M::type_name; });
    REQUIRE(example != vectors.end());
    const std::vector<std::byte> bytes = from_hex((*example)["frame"]);
    const std::span<const std::byte> payload = std::span(bytes).subspan(FrameHeader::bytes);
    const std::span<const std::byte, FrameHeader::bytes> head(bytes.data(), FrameHeader::bytes);
    const FrameHeader header = decode_header(head, 1 << 20);
    REQUIRE_NOTHROW(verify_checksum(head, payload));
    CHECK(header.type == M::id);
    CHECK(header.sequence == M::id + 1u);
    CHECK(header.step == M::id + 1000u);

    M message;
    Reader reader(payload);
    message.decode(reader);
    message.visit([&](const char* name, const char*, const auto& field) {
      INFO(name);
      CHECK(same(field, (*example)["fields"][name]));
    });
    std::vector<std::byte> again;
    Writer writer(again);
    message.encode(writer);
    CHECK(std::equal(again.begin(), again.end(), payload.begin(), payload.end()));
    const HeaderBytes same_head =
        encode_header({.type = M::id, .sequence = header.sequence, .step = header.step}, {&payload, 1});
    CHECK(std::equal(head.begin(), head.end(), same_head.begin()));
  });
}
