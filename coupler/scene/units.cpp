#include "coupler/scene/units.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <numbers>
#include <optional>
#include <vector>

#include "coupler/scene/problem.hpp"

namespace gabion::scene {
namespace {

/// value in SI = number * 10^exponent * factor; powers of ten are kept apart because they are exact as text.
struct Unit {
  std::string_view symbol;
  Dimension dimension;
  int exponent;
  double factor;
  bool takes_prefix;
};

constexpr double seconds_per_minute = 60.0;

const Unit known_units[] = {
    {"m", {.length = 1}, 0, 1.0, true},
    {"g", {.mass = 1}, -3, 1.0, true},
    {"t", {.mass = 1}, 3, 1.0, true},
    {"s", {.time = 1}, 0, 1.0, true},
    {"min", {.time = 1}, 0, seconds_per_minute, false},
    {"N", {1, 1, -2, 0}, 0, 1.0, true},
    {"Pa", {1, -1, -2, 0}, 0, 1.0, true},
    {"bar", {1, -1, -2, 0}, 5, 1.0, true},
    {"J", {1, 2, -2, 0}, 0, 1.0, true},
    {"W", {1, 2, -3, 0}, 0, 1.0, true},
    {"Hz", {.time = -1}, 0, 1.0, true},
    {"rad", {.angle = 1}, 0, 1.0, true},
    {"deg", {.angle = 1}, 0, std::numbers::pi / 180.0, false},
    {"%", {}, -2, 1.0, false},
};

struct Prefix {
  std::string_view symbol;
  int exponent;
};

constexpr Prefix prefixes[] = {{"n", -9}, {"u", -6}, {"m", -3}, {"c", -2}, {"d", -1}, {"k", 3}, {"M", 6}, {"G", 9}};

struct UnitProduct {
  Dimension dimension;
  int exponent = 0;
  double factor = 1.0;
};

std::string_view trimmed(std::string_view text) {
  const auto first = text.find_first_not_of(" \t\n\r");
  if (first == std::string_view::npos) return {};
  return text.substr(first, text.find_last_not_of(" \t\n\r") - first + 1);
}

/// Writes the few signs outside ASCII in ASCII.
std::string plain(std::string_view text) {
  struct Sign {
    std::string_view from, to;
  };
  static constexpr Sign signs[] = {{"\u00b2", "2"}, {"\u00b3", "3"},   {"\u00b5", "u"}, {"\u03bc", "u"},
                                   {"\u00b7", "*"}, {"\u00b0", "deg"}, {"\u2212", "-"}};
  std::string result(text);
  for (const Sign& sign : signs)
    for (std::size_t at; (at = result.find(sign.from)) != std::string::npos;)
      result.replace(at, sign.from.size(), sign.to);
  return result;
}

Unit find_unit(std::string_view symbol) {
  for (const Unit& unit : known_units)
    if (unit.symbol == symbol) return unit;
  for (const Unit& unit : known_units)
    for (const Prefix& prefix : prefixes) {
      const bool fits = unit.takes_prefix && symbol.size() == prefix.symbol.size() + unit.symbol.size() &&
                        symbol.starts_with(prefix.symbol) && symbol.ends_with(unit.symbol);
      if (fits) return {unit.symbol, unit.dimension, unit.exponent + prefix.exponent, unit.factor, false};
    }
  throw UnitError("unknown unit " + quoted(std::string(symbol)));
}

bool is_letter(char c) {
  return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '%';
}

/// A whole power after a unit, as in m2, m^2, m-1; 1 when there is none. Moves text behind it.
int take_power(std::string_view& text) {
  if (text.starts_with('^')) text.remove_prefix(1);
  int power = 1;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), power);
  if (error != std::errc{}) return 1;
  text.remove_prefix(static_cast<std::size_t>(end - text.data()));
  constexpr int largest = 9;
  if (std::abs(power) > largest) throw UnitError("a power above 9");
  return power;
}

UnitProduct parse_product(std::string_view text) {
  UnitProduct product;
  const std::string_view whole = text;
  int sign = 1;  // of the next factor's power: -1 after '/'
  bool expects_factor = false;
  while (!text.empty()) {
    const char c = text.front();
    if (c == ' ' || c == '*' || c == '/') {
      if (c != ' ') {
        if (expects_factor) throw UnitError("two signs in a row in the unit " + quoted(std::string(whole)));
        sign = c == '/' ? -1 : 1;
        expects_factor = true;
      }
      text.remove_prefix(1);
      continue;
    }
    if (text.starts_with("1/")) {  // as in "1/s"
      text.remove_prefix(1);
      expects_factor = false;
      continue;
    }
    const auto letters = static_cast<std::size_t>(std::find_if_not(text.begin(), text.end(), is_letter) - text.begin());
    if (letters == 0) throw UnitError("cannot read the unit " + quoted(std::string(whole)));
    const Unit unit = find_unit(text.substr(0, letters));
    text.remove_prefix(letters);
    const int power = sign * take_power(text);
    product.dimension.mass += power * unit.dimension.mass;
    product.dimension.length += power * unit.dimension.length;
    product.dimension.time += power * unit.dimension.time;
    product.dimension.angle += power * unit.dimension.angle;
    product.exponent += power * unit.exponent;
    product.factor *= std::pow(unit.factor, power);
    sign = 1;
    expects_factor = false;
  }
  if (expects_factor) throw UnitError("the unit " + quoted(std::string(whole)) + " ends with a sign");
  return product;
}

/// The number as text with its decimal exponent raised: rounding happens once, so 57 mm equals 0.057 m.
double scaled_number(std::string_view number, int exponent) {
  const auto e = number.find_first_of("eE");
  if (e != std::string_view::npos) {
    std::string_view own_text = number.substr(e + 1);
    if (own_text.starts_with('+')) own_text.remove_prefix(1);
    int own = 0;
    const auto [end, error] = std::from_chars(own_text.data(), own_text.data() + own_text.size(), own);
    if (error != std::errc{} || end != own_text.data() + own_text.size()) throw UnitError("the number is out of range");
    exponent += own;
    number = number.substr(0, e);
  }
  const std::string text = std::string(number) + "e" + std::to_string(exponent);
  double value = 0.0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc{} || end != text.data() + text.size()) throw UnitError("the number is out of range");
  return value;
}

struct UnitName {
  std::string_view unit, description;
};

const UnitName unit_names[] = {
    {"1", "a number without unit, such as 0.5 or '1e-6'"},
    {"m", "a length, such as '0.5 m' or '57 mm'"},
    {"s", "a time, such as '0.5 s' or '5 ms'"},
    {"kg", "a mass, such as '10 t' or '250 kg'"},
    {"m/s", "a velocity, such as '13 m/s' or '1 mm/s'"},
    {"m/s2", "an acceleration, such as '-9.81 m/s2'"},
    {"Pa", "a stress, such as '500 MPa' or '10 kPa'"},
    {"N/m2", "a stiffness over radius, such as '1.77e9 N/m2' or '3.78 GPa'"},
    {"kg/m3", "a density, such as '2650 kg/m3'"},
    {"rad", "an angle, such as '30 deg' or '0.05 rad'"},
    {"rad/s", "an angular velocity, such as '1 rad/s' or '90 deg/s'"},
};

}  // namespace

Quantity parse_quantity(std::string_view original) {
  const std::string ascii = plain(original);
  std::string_view text = trimmed(ascii);
  if (text.starts_with('+') && !text.starts_with("+-")) text.remove_prefix(1);
  double unscaled = 0.0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), unscaled);
  if (error == std::errc::invalid_argument) throw UnitError("it does not begin with a number");
  const auto length = static_cast<std::size_t>(end - text.data());
  const std::string_view number = text.substr(0, length);
  if (number.find_first_of("nN") != std::string_view::npos)
    throw UnitError("it does not begin with a number");  // inf, nan
  const UnitProduct unit = parse_product(trimmed(text.substr(length)));
  const double value = scaled_number(number, unit.exponent) * unit.factor;
  if (!std::isfinite(value)) throw UnitError("the number is out of range");
  return {value + 0.0, unit.dimension};  // + 0.0 turns -0 into 0
}

Dimension parse_unit(std::string_view unit) {
  if (unit == "1") return {};
  return parse_product(plain(trimmed(unit))).dimension;
}

bool means_infinite(std::string_view text) {
  std::string lowered(trimmed(text));
  for (char& c : lowered) c = c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
  return lowered == "inf" || lowered == "infinite" || lowered == "infinity";
}

std::string format_quantity(double value, std::string_view unit) {
  if (std::isinf(value)) return "infinite";
  constexpr double smallest_fixed = 1e-4, largest_fixed = 1e12;
  const double magnitude = std::abs(value);
  const bool fixed = value == 0.0 || (magnitude >= smallest_fixed && magnitude < largest_fixed);
  char buffer[64];
  const auto end = std::to_chars(buffer, buffer + sizeof buffer, value + 0.0,
                                 fixed ? std::chars_format::fixed : std::chars_format::scientific)
                       .ptr;
  const std::string number(buffer, end);
  return unit == "1" ? number : number + " " + std::string(unit);
}

std::string describe_unit(std::string_view unit) {
  for (const UnitName& name : unit_names)
    if (name.unit == unit) return std::string(name.description);
  return "a quantity in " + std::string(unit);
}

}  // namespace gabion::scene
