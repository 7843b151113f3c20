#pragma once
// Fills any message with random values whose shapes are what the catalogue says.

#include <map>
#include <random>

#include "protocol/messages.hpp"

namespace gabion::protocol {

class RandomFields {
 public:
  explicit RandomFields(unsigned seed) : random_(seed) {}

  template <class M>
  M make() {
    sizes_.clear();
    M message;
    message.visit([this](const char*, std::string_view shape, auto& field) { this->fill(field, shape); });
    return message;
  }

 private:
  template <class T>
  requires std::is_arithmetic_v<T>
  void fill(T& value, std::string_view) {
    if constexpr (std::is_floating_point_v<T>)
      value = std::normal_distribution<>(0, 1e6)(random_);
    else
      value = static_cast<T>(random_());
  }
  void fill(std::string& text, std::string_view) {
    text.resize(random_() % 20);
    for (char& c : text) c = static_cast<char>(random_());
  }
  void fill(std::vector<std::string>& texts, std::string_view) {
    texts.resize(random_() % 5);
    for (std::string& text : texts) fill(text, "");
  }
  template <class T>
  void fill(Array<T>& array, std::string_view shape) {
    std::vector<std::uint64_t> extents;
    shape = shape.substr(1, shape.size() - 2);
    while (!shape.empty()) {
      const std::size_t comma = std::min(shape.find(','), shape.size());
      extents.push_back(extent(shape.substr(0, comma)));
      shape.remove_prefix(std::min(comma + 1, shape.size()));
    }
    array.set_shape(extents);
    array.data.resize(array.product());
    for (T& value : array.data) fill(value, "");
  }
  std::uint64_t extent(std::string_view text) {
    if (std::isdigit(text[0])) return static_cast<std::uint64_t>(text[0] - '0');
    const bool plus = text.ends_with("+1");
    const std::string symbol(plus ? text.substr(0, text.size() - 2) : text);
    if (!sizes_.contains(symbol)) sizes_[symbol] = random_() % 9;
    return sizes_[symbol] + (plus ? 1 : 0);
  }

  std::mt19937_64 random_;
  std::map<std::string, std::uint64_t> sizes_;
};

/// Calls test(M{}) for every message of the catalogue.
template <class Test>
void for_each_message(Test&& test) {
  [&]<class... M>(std::tuple<M...>*) { (test(M{}), ...); }(static_cast<AllMessages*>(nullptr));
}

}  // namespace gabion::protocol
