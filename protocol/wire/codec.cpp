#include "protocol/wire/codec.hpp"

namespace gabion::protocol {

namespace {

std::string shape_text(std::span<const std::uint64_t> shape) {
  std::string text = "[";
  for (const std::uint64_t extent : shape) text += (text.size() > 1 ? "," : "") + std::to_string(extent);
  return text + "]";
}

}  // namespace

void Sizes::check(const ShapeRule& rule, std::span<const std::uint64_t> shape) {
  const auto refuse = [&](const std::string& why) {
    throw CodecError(std::string(rule.field) + ": shape " + shape_text(shape) + " where " + rule.text + " is due" +
                     why);
  };
  if (shape.empty() || shape.size() > 3) refuse(" (1 to 3 dimensions)");
  if (rule.dims == 0) return;
  if (shape.size() != rule.dims) refuse("");
  for (std::size_t axis = 0; axis < shape.size(); ++axis) {
    const Extent& extent = rule.extents[axis];
    if (extent.symbol == -2) continue;
    if (extent.symbol == -1) {
      if (shape[axis] != extent.fixed) refuse("");
      continue;
    }
    // An empty row pointer stands for that of no rows.
    const std::uint64_t size = shape[axis] >= extent.plus ? shape[axis] - extent.plus : 0;
    const auto symbol = static_cast<std::size_t>(extent.symbol);
    if (bound_by_[symbol] == nullptr) {
      bound_by_[symbol] = rule.field;
      value_[symbol] = size;
    } else if (value_[symbol] != size) {
      refuse(" and " + std::string(bound_by_[symbol]) + " made it " + std::to_string(value_[symbol]) +
             (extent.plus ? " + 1" : ""));
    }
  }
}

void Writer::put_raw(const void* bytes, std::size_t count) {
  const auto* first = static_cast<const std::byte*>(bytes);
  out_.insert(out_.end(), first, first + count);
}

void Writer::put(const std::string& text) {
  if (text.size() > UINT32_MAX) throw CodecError("a string of " + std::to_string(text.size()) + " bytes is too long");
  put(static_cast<std::uint32_t>(text.size()));
  put_raw(text.data(), text.size());
}

void Writer::put(const std::vector<std::string>& texts) {
  if (texts.size() > UINT32_MAX) throw CodecError(std::to_string(texts.size()) + " strings are too many");
  put(static_cast<std::uint32_t>(texts.size()));
  for (const std::string& text : texts) put(text);
}

const std::byte* Reader::take(std::size_t count, const char* field) {
  if (count > bytes_.size())
    throw CodecError(std::string(field) + ": " + std::to_string(count) + " bytes are due, " +
                     std::to_string(bytes_.size()) + " are left");
  const std::byte* first = bytes_.data();
  bytes_ = bytes_.subspan(count);
  return first;
}

void Reader::get(std::string& text, const char* field) {
  std::uint32_t length = 0;
  get(length, field);
  const std::byte* first = take(length, field);
  text.assign(reinterpret_cast<const char*>(first), length);
}

void Reader::get(std::vector<std::string>& texts, const char* field) {
  std::uint32_t count = 0;
  get(count, field);
  // Each string takes at least its length, so a count that lies is found before memory is taken.
  if (std::uint64_t{count} * sizeof(std::uint32_t) > bytes_.size())
    throw CodecError(std::string(field) + ": " + std::to_string(count) + " strings do not fit the " +
                     std::to_string(bytes_.size()) + " bytes left");
  texts.resize(count);
  for (std::string& text : texts) get(text, field);
}

std::uint64_t Reader::array_head(std::uint8_t& dims, std::array<std::uint64_t, 3>& shape, std::size_t value_size,
                                 const ShapeRule& rule, Sizes& sizes) {
  std::uint8_t count = 0;
  get(count, rule.field);
  if (count < 1 || count > 3)
    throw CodecError(std::string(rule.field) + ": " + std::to_string(count) + " dimensions, 1 to 3 are possible");
  std::array<std::uint64_t, 3> extents{};
  for (std::uint8_t axis = 0; axis < count; ++axis) get(extents[axis], rule.field);
  const std::span<const std::uint64_t> due(extents.data(), count);
  sizes.check(rule, due);
  // A zero extent makes the array empty whatever the others say; without one the running product only
  // grows, so it is stopped at what is left before it can overflow.
  const std::uint64_t most = bytes_.size() / value_size;
  std::uint64_t values = 1;
  for (const std::uint64_t extent : due) {
    if (extent == 0) {
      values = 0;
      break;
    }
  }
  if (values != 0)
    for (const std::uint64_t extent : due) {
      if (extent > most / values)
        throw CodecError(std::string(rule.field) + ": shape " + shape_text(due) + " does not fit the " +
                         std::to_string(bytes_.size()) + " bytes left");
      values *= extent;
    }
  dims = count;
  shape = extents;
  return values;
}

void Reader::finish(const char* message) const {
  if (!bytes_.empty())
    throw CodecError(std::string(message) + ": " + std::to_string(bytes_.size()) + " bytes too many");
}

}  // namespace gabion::protocol
