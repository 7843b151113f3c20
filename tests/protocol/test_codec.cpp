#include <catch2/catch.hpp>
#include <cmath>

#include "random_message.hpp"

using namespace gabion::protocol;

namespace {

template <class M>
std::vector<std::byte> encoded(const M& message) {
  std::vector<std::byte> bytes;
  Writer writer(bytes);
  message.encode(writer);
  return bytes;
}

template <class M>
void decode(M& message, std::span<const std::byte> bytes) {
  Reader reader(bytes);
  message.decode(reader);
}

/// An array's bytes with a head of the caller's choice.
std::vector<std::byte> array_bytes(std::uint8_t dims, std::vector<std::uint64_t> shape, std::size_t values) {
  std::vector<std::byte> bytes;
  Writer writer(bytes);
  writer.put(dims);
  for (const std::uint64_t extent : shape) writer.put(extent);
  bytes.resize(bytes.size() + 8 * values);
  return bytes;
}

}  // namespace

TEST_CASE("every message comes back as it was sent") {
  RandomFields random(1);
  for_each_message([&]<class M>(M) {
    INFO(M::type_name);
    for (int round = 0; round < 50; ++round) {
      const M sent = random.make<M>();
      M received = random.make<M>();  // what was there before must not show
      decode(received, encoded(sent));
      REQUIRE(received == sent);
    }
  });
}

TEST_CASE("a payload with any number of bytes missing, or one too many, is refused") {
  RandomFields random(2);
  for_each_message([&]<class M>(M) {
    INFO(M::type_name);
    std::vector<std::byte> bytes = encoded(random.make<M>());
    M message;
    for (std::size_t length = 0; length < bytes.size(); ++length)
      REQUIRE_THROWS_AS(decode(message, std::span(bytes).first(length)), CodecError);
    bytes.push_back(std::byte{0});
    REQUIRE_THROWS_AS(decode(message, bytes), CodecError);
  });
}

TEST_CASE("random bytes never decode to more than they hold") {
  RandomFields random(3);
  std::mt19937_64 noise(4);
  for_each_message([&]<class M>(M) {
    for (int round = 0; round < 200; ++round) {
      std::vector<std::byte> bytes = encoded(random.make<M>());
      for (int changes = 0; changes < 3 && !bytes.empty(); ++changes)
        bytes[noise() % bytes.size()] = static_cast<std::byte>(noise());
      M message;
      try {
        decode(message, bytes);
        CHECK(encoded(message).size() == bytes.size());
      } catch (const CodecError&) {
      }
    }
  });
}

TEST_CASE("values that numbers can take survive") {
  Run run;
  for (const double value : {0.0, -0.0, double{INFINITY}, -double{INFINITY}, 5e-324, 1.7976931348623157e308}) {
    run.dt = value;
    Run received;
    decode(received, encoded(run));
    CHECK(std::signbit(received.dt) == std::signbit(value));
    CHECK(received.dt == value);
  }
  run.dt = NAN;
  Run received;
  decode(received, encoded(run));
  CHECK(std::isnan(received.dt));
}

TEST_CASE("an array of the wrong shape is refused with field, shape and what is due") {
  Gap gap;
  CHECK_THROWS_WITH(decode(gap, array_bytes(1, {6}, 6)), "GAP.values: shape [6] where [r,3] is due");
  CHECK_THROWS_WITH(decode(gap, array_bytes(2, {3, 2}, 6)), "GAP.values: shape [3,2] where [r,3] is due");
  CHECK_THROWS_WITH(decode(gap, array_bytes(3, {1, 2, 3}, 6)), "GAP.values: shape [1,2,3] where [r,3] is due");
  CHECK_THROWS_WITH(decode(gap, array_bytes(0, {}, 0)), "GAP.values: 0 dimensions, 1 to 3 are possible");
  CHECK_THROWS_WITH(decode(gap, array_bytes(4, {1, 1, 1, 3}, 3)), "GAP.values: 4 dimensions, 1 to 3 are possible");
  CHECK_NOTHROW(decode(gap, array_bytes(2, {2, 3}, 6)));
}

TEST_CASE("sizes that no memory could hold are refused before memory is taken") {
  Gap gap;
  const std::uint64_t most = ~std::uint64_t{0};
  for (const std::uint64_t rows : {most, most / 3, most / 24 + 1, std::uint64_t{1} << 61, std::uint64_t{1} << 40})
    CHECK_THROWS_AS(decode(gap, array_bytes(2, {rows, 3}, 2)), CodecError);
  Field field;
  std::vector<std::byte> bytes;
  Writer writer(bytes);
  writer.put(std::string("x"));
  const auto head = array_bytes(3, {std::uint64_t{1} << 32, std::uint64_t{1} << 32, 4}, 0);
  bytes.insert(bytes.end(), head.begin(), head.end());
  CHECK_THROWS_AS(decode(field, bytes), CodecError);
  Welcome welcome;
  CHECK_THROWS_AS(decode(welcome, array_bytes(0, {most, most}, 0)), CodecError);
}

TEST_CASE("fields of one message must agree on a size") {
  Grains grains;
  grains.position = std::vector<double>(6);
  grains.radius = std::vector<double>(3);
  grains.material = std::vector<std::int32_t>(2);
  CHECK_THROWS_WITH(encoded(grains), "GRAINS.radius: shape [3] where [n] is due and GRAINS.position made it 2");
  Sponge sponge;
  sponge.grains = std::vector<std::int32_t>(4);
  sponge.beta = std::vector<double>(4);
  sponge.row_ptr = std::vector<std::int32_t>(4);
  CHECK_THROWS_WITH(encoded(sponge), "SPONGE.row_ptr: shape [4] where [p+1] is due and SPONGE.grains made it 4 + 1");
}

TEST_CASE("an array takes values by rows and keeps its width") {
  Grains grains;
  grains.position = std::vector<double>{1, 2, 3, 4, 5, 6};
  CHECK(grains.position.rows() == 2);
  CHECK(grains.position.row(1)[2] == 6);
  CHECK_THROWS_AS(grains.position = std::vector<double>(4), CodecError);
  CHECK_THROWS_AS(grains.position.assign(std::vector<double>(4), {2, 3}), CodecError);
  CHECK(Homogenised().stiffness.size() == 36);
}

TEST_CASE("the message table says where a message is allowed") {
  CHECK(find_message(Gap::id)->name == "GAP");
  CHECK(find_message(Run::id)->reply == RunDone::id);
  CHECK(find_message(Run::id)->allowed_in(SessionState::ready));
  CHECK_FALSE(find_message(Run::id)->allowed_in(SessionState::configuring));
  CHECK(find_message(999) == nullptr);
  CHECK(message_name(999) == "message 999");
}
