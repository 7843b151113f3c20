#include "protocol/engine/history.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>

namespace gabion::engine {

History::History(const std::string& kind, std::vector<double> parameters)
    : parameters_(std::move(parameters)) {
  const auto expect = [&](bool ok, const char* what) {
    if (!ok) throw std::invalid_argument("history '" + kind + "' needs " + what);
  };
  const std::size_t n = parameters_.size();
  if (kind == "zero") {
    kind_ = Kind::zero;
  } else if (kind == "constant") {
    kind_ = Kind::constant;
    expect(n == 1, "one value");
  } else if (kind == "ramp") {
    kind_ = Kind::ramp;
    expect(n == 3 && parameters_[2] >= 0, "value, start and a rise time of at least 0");
  } else if (kind == "half_sine") {
    kind_ = Kind::half_sine;
    expect(n == 3 && parameters_[2] > 0, "amplitude, start and a duration above 0");
  } else if (kind == "table") {
    kind_ = Kind::table;
    expect(n >= 2 && n % 2 == 0, "pairs of time and value");
    for (std::size_t i = 2; i < n; i += 2)
      expect(parameters_[i] > parameters_[i - 2], "increasing times");
  } else {
    throw std::invalid_argument("unknown history '" + kind +
                                "'; known: zero, constant, ramp, half_sine, table");
  }
}

double History::at(double time) const {
  const auto& p = parameters_;
  switch (kind_) {
    case Kind::zero:
      return 0.0;
    case Kind::constant:
      return p[0];
    case Kind::ramp:
      if (p[2] == 0.0) return time >= p[1] ? p[0] : 0.0;
      return p[0] * std::clamp((time - p[1]) / p[2], 0.0, 1.0);
    case Kind::half_sine: {
      const double phase = (time - p[1]) / p[2];
      return phase > 0.0 && phase < 1.0 ? p[0] * std::sin(std::numbers::pi * phase) : 0.0;
    }
    case Kind::table: {
      if (time <= p[0]) return p[1];
      for (std::size_t i = 2; i < p.size(); i += 2)
        if (time <= p[i])
          return p[i - 1] + (p[i + 1] - p[i - 1]) * (time - p[i - 2]) / (p[i] - p[i - 2]);
      return p.back();
    }
  }
  return 0.0;
}

}  // namespace gabion::engine
