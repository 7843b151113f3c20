#pragma once
// Values to bytes and back: little-endian, no padding, every size checked before memory is taken.
// Messages call this from generated code; PROTOCOL.md, "Types", is the specification.

#include <algorithm>
#include <array>
#include <bit>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <initializer_list>
#include <span>
#include <stdexcept>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

namespace gabion::protocol {

static_assert(std::endian::native == std::endian::little, "the wire is little-endian, and so must be the machine");

/// A payload that does not say what its message must say; the text names message and field.
struct CodecError : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// An array with 1 to 3 dimensions, last index fastest.
template <class T>
struct Array {
  std::uint8_t dims = 1;
  std::array<std::uint64_t, 3> shape{};
  std::vector<T> data;

  Array() = default;
  /// Zeros; Array<double>{0, 3} is an empty array of triples.
  template <std::integral... Extents>
  explicit Array(Extents... extents) : dims(sizeof...(Extents)), shape{static_cast<std::uint64_t>(extents)...} {
    static_assert(sizeof...(Extents) >= 1 && sizeof...(Extents) <= 3);
    data.resize(product());
  }

  std::uint64_t rows() const { return shape[0]; }
  std::uint64_t row_size() const { return (dims > 1 ? shape[1] : 1) * (dims > 2 ? shape[2] : 1); }
  std::size_t size() const { return data.size(); }
  bool empty() const { return data.empty(); }
  std::span<const std::uint64_t> extents() const { return {shape.data(), dims}; }

  T& operator[](std::size_t i) { return data[i]; }
  const T& operator[](std::size_t i) const { return data[i]; }
  auto begin() const { return data.begin(); }
  auto end() const { return data.end(); }
  std::span<const T> row(std::size_t i) const { return {data.data() + i * row_size(), row_size()}; }
  std::span<T> row(std::size_t i) { return {data.data() + i * row_size(), row_size()}; }

  /// Copies values into a new shape. CodecError when their number does not fit it.
  void assign(std::span<const T> values, std::initializer_list<std::uint64_t> new_shape) {
    set_shape(std::span<const std::uint64_t>(new_shape.begin(), new_shape.size()));
    if (values.size() != product())
      throw CodecError(std::to_string(values.size()) + " values do not fill a shape of " + std::to_string(product()));
    data.assign(values.begin(), values.end());
  }
  /// Zeros in a new shape.
  void resize(std::initializer_list<std::uint64_t> new_shape) {
    set_shape(std::span<const std::uint64_t>(new_shape.begin(), new_shape.size()));
    data.assign(product(), T{});
  }
  /// Takes the values and keeps the row size: a vector of 3 n numbers into an array of triples.
  Array& operator=(std::vector<T> values) {
    const std::uint64_t width = row_size();
    if (width == 0 || values.size() % width != 0)
      throw CodecError(std::to_string(values.size()) + " values do not divide into rows of " + std::to_string(width));
    shape[0] = values.size() / width;
    data = std::move(values);
    return *this;
  }
  /// Keeps the data; the caller sizes it. CodecError when there are not 1 to 3 extents.
  void set_shape(std::span<const std::uint64_t> new_shape) {
    if (new_shape.empty() || new_shape.size() > 3) throw CodecError("an array has 1 to 3 dimensions");
    dims = static_cast<std::uint8_t>(new_shape.size());
    shape = {};
    std::copy(new_shape.begin(), new_shape.end(), shape.begin());
  }
  std::uint64_t product() const { return shape[0] * row_size(); }

  bool operator==(const Array&) const = default;
};

/// One extent of a shape: a number, or a symbol (perhaps plus one) that has one value in a message.
struct Extent {
  int symbol;           ///< 0 and up: index of the symbol; -1: fixed; -2: anything
  std::uint64_t plus;   ///< 1 for "n+1"
  std::uint64_t fixed;  ///< the number when symbol is -1
};

/// The catalogue's shape of a field; dims 0 accepts any.
struct ShapeRule {
  const char* field;
  const char* text;
  std::uint8_t dims;
  std::array<Extent, 3> extents;
};

/// Values that the symbols of a message's shapes have taken so far.
class Sizes {
 public:
  /// CodecError when shape is not what the rule says, or contradicts an earlier field of the message.
  void check(const ShapeRule& rule, std::span<const std::uint64_t> shape);

 private:
  std::array<std::uint64_t, 8> value_{};
  std::array<const char*, 8> bound_by_{};
};

/// Appends to a buffer that the caller keeps and re-uses.
class Writer {
 public:
  explicit Writer(std::vector<std::byte>& out) : out_(out) {}

  void put(std::uint8_t value) { put_raw(&value, sizeof value); }
  void put(std::uint16_t value) { put_raw(&value, sizeof value); }
  void put(std::uint32_t value) { put_raw(&value, sizeof value); }
  void put(std::uint64_t value) { put_raw(&value, sizeof value); }
  void put(double value) { put_raw(&value, sizeof value); }
  void put(const std::string& text);
  void put(const std::vector<std::string>& texts);

  template <class T>
  void put(const Array<T>& array, const ShapeRule& rule, Sizes& sizes) {
    sizes.check(rule, array.extents());
    if (array.product() != array.data.size())
      throw CodecError(std::string(rule.field) + ": " + std::to_string(array.data.size()) + " values in a shape of " +
                       std::to_string(array.product()));
    put(array.dims);
    put_raw(array.shape.data(), array.dims * sizeof(std::uint64_t));
    put_raw(array.data.data(), array.data.size() * sizeof(T));
  }

  void put_raw(const void* bytes, std::size_t count);

 private:
  std::vector<std::byte>& out_;
};

/// Reads a payload; every get throws CodecError, naming the field, when the bytes run out.
class Reader {
 public:
  explicit Reader(std::span<const std::byte> bytes) : bytes_(bytes) {}

  template <class T>
  requires std::is_arithmetic_v<T>
  void get(T& value, const char* field) { std::memcpy(&value, take(sizeof value, field), sizeof value); }
  void get(std::string& text, const char* field);
  void get(std::vector<std::string>& texts, const char* field);

  template <class T>
  void get(Array<T>& array, const ShapeRule& rule, Sizes& sizes) {
    const std::uint64_t count = array_head(array.dims, array.shape, sizeof(T), rule, sizes);
    array.data.resize(count);
    if (count > 0) std::memcpy(array.data.data(), take(count * sizeof(T), rule.field), count * sizeof(T));
  }

  /// CodecError when bytes are left over.
  void finish(const char* message) const;
  std::size_t remaining() const { return bytes_.size(); }

 private:
  const std::byte* take(std::size_t count, const char* field);
  /// Reads and checks dimensions; returns the number of values, which are sure to be there.
  std::uint64_t array_head(std::uint8_t& dims, std::array<std::uint64_t, 3>& shape, std::size_t value_size,
                           const ShapeRule& rule, Sizes& sizes);

  std::span<const std::byte> bytes_;
};

}  // namespace gabion::protocol
