#include <catch2/catch.hpp>
#include <cmath>
#include <numbers>
#include <random>

#include "coupler/scene/units.hpp"

using namespace gabion::scene;

TEST_CASE("quantities are read in SI") {
  struct Case {
    const char* text;
    double value;
    const char* unit;
  };
  const Case cases[] = {
      {"500 MPa", 5e8, "Pa"},
      {"13 m/s", 13, "m/s"},
      {"9.81 m/s2", 9.81, "m/s2"},
      {"-9.81 m/s^2", -9.81, "m/s2"},
      {"10 t", 1e4, "kg"},
      {"10t", 1e4, "kg"},
      {"5 ms", 5e-3, "s"},
      {"2 min", 120, "s"},
      {"0.057 m", 0.057, "m"},
      {"2650 kg/m3", 2650, "kg/m3"},
      {"2.65 g/cm3", 2650, "kg/m3"},
      {"1.77e9 N/m", 1.77e9, "N/m"},
      {"1e-6", 1e-6, "1"},
      {"5 %", 0.05, "1"},
      {"+3 mm", 3e-3, "m"},
      {"1 kN s/m", 1e3, "kg/s"},
      {"1 N*s/m", 1, "kg/s"},
      {"3 kPa", 3e3, "N/m2"},
      {"3.78 GPa", 3.78e9, "N/m2"},
      {"1 bar", 1e5, "Pa"},
      {"1000 1/s", 1e3, "Hz"},
      {"  7   um ", 7e-6, "m"},
      {"2 m²", 2, "m2"},
      {"4 µm", 4e-6, "m"},
      {"1 m/s/s", 1, "m/s2"},
      {"0", 0, "1"},
      {"1e3 J", 1e3, "N m"},
  };
  for (const Case& c : cases) {
    INFO(c.text);
    const Quantity q = parse_quantity(c.text);
    CHECK(q.value == c.value);
    CHECK(q.dimension == parse_unit(c.unit));
  }
  CHECK(parse_quantity("30 deg").value == Approx(std::numbers::pi / 6).epsilon(1e-15));
  CHECK_FALSE(parse_unit("rad/s") == parse_unit("1/s"));
  CHECK_FALSE(std::signbit(parse_quantity("-0 m").value));
}

TEST_CASE("text that is no quantity is refused") {
  for (const char* text : {"", "m", "inf", "nan", "5 furlongs", "5 m/", "5 m//s", "1e999 m", "5 m^99", "5 (m)", "5,3 m",
                           "--5 m", "0x10 m", "5 MMPa", "5 1", "5 mmin"}) {
    INFO(text);
    CHECK_THROWS_AS(parse_quantity(text), UnitError);
  }
}

TEST_CASE("prefixes round once: the same quantity gives the same bits") {
  CHECK(parse_quantity("57 mm").value == 0.057);
  CHECK(parse_quantity("0.1 mm").value == 1e-4);
  CHECK(parse_quantity("0.3 GPa").value == 3e8);
  std::mt19937_64 random(7);
  std::uniform_int_distribution<int> digits(1, 99999999), exponent(-12, 12);
  for (int i = 0; i < 2000; ++i) {
    const int n = digits(random), e = exponent(random);
    const std::string mm = std::to_string(n) + "e" + std::to_string(e) + " mm";
    const std::string m = std::to_string(n) + "e" + std::to_string(e - 3) + " m";
    REQUIRE(parse_quantity(mm).value == parse_quantity(m).value);
  }
}

TEST_CASE("written quantities are read back bit for bit") {
  std::mt19937_64 random(11);
  std::uniform_real_distribution<double> mantissa(-10, 10), exponent(-30, 30);
  for (const char* unit : {"1", "m", "s", "kg", "m/s", "m/s2", "Pa", "N/m2", "kg/m3", "rad", "rad/s"}) {
    for (int i = 0; i < 500; ++i) {
      const double value = mantissa(random) * std::pow(10.0, exponent(random));
      const std::string text = format_quantity(value, unit);
      INFO(text);
      const Quantity q = parse_quantity(text);
      REQUIRE(q.value == value);
      REQUIRE(q.dimension == parse_unit(unit));
    }
  }
  CHECK(format_quantity(5e8, "Pa") == "500000000 Pa");
  CHECK(format_quantity(0.057, "m") == "0.057 m");
  CHECK(format_quantity(-0.0, "m") == "0 m");
  CHECK(format_quantity(INFINITY, "N/m2") == "infinite");
  CHECK(format_quantity(0.5, "1") == "0.5");
}

TEST_CASE("infinite has three spellings") {
  for (const char* text : {"inf", "Infinite", " infinity "}) CHECK(means_infinite(text));
  for (const char* text : {"", "infini", "1", "-inf"}) CHECK_FALSE(means_infinite(text));
}

TEST_CASE("units say what they measure") {
  CHECK(describe_unit("Pa") == "a stress, such as '500 MPa' or '10 kPa'");
  CHECK(describe_unit("N s/m") == "a quantity in N s/m");
}
