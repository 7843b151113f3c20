#pragma once
// Quantities as text, "500 MPa", and their SI values.

#include <stdexcept>
#include <string>
#include <string_view>

namespace gabion::scene {

/// Powers of the base units; angles are kept apart, so that rad/s is not 1/s.
struct Dimension {
  int mass = 0, length = 0, time = 0, angle = 0;
  bool operator==(const Dimension&) const = default;
};

struct Quantity {
  double value = 0.0;  ///< SI
  Dimension dimension;
};

/// The text is no quantity; what() says why.
class UnitError : public std::invalid_argument {
 public:
  using std::invalid_argument::invalid_argument;
};

/// A number and, unless it is dimensionless, a unit: products of m, g, t, s, min, N, Pa, bar, J, W, Hz, rad, deg and %
/// with the usual prefixes and whole powers, such as "1.2 kN s/m", "9.81 m/s2", "3 mm^2". "50 mm" and
/// "0.05 m" give the same bits. Throws UnitError; infinite values are not accepted here.
Quantity parse_quantity(std::string_view text);

/// The dimension of a unit such as "kg/m3"; "1" is dimensionless. Throws UnitError.
Dimension parse_unit(std::string_view unit);

/// "inf", "infinite" or "infinity", either case.
bool means_infinite(std::string_view text);

/// Shortest text that parse_quantity turns back into the same bits: "500000000 Pa"; unit "1" writes the number
/// alone, infinity is "infinite".
std::string format_quantity(double value, std::string_view unit);

/// What a unit of the schema measures and how it is written: "a length, such as '0.5 m' or '57 mm'".
std::string describe_unit(std::string_view unit);

}  // namespace gabion::scene
