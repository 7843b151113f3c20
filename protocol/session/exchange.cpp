#include "protocol/session/exchange.hpp"

#include <cmath>
#include <limits>

namespace gabion::protocol {

namespace {

void check_finite(std::span<const double> rows, const char* message, const char* advice) {
  bool finite = true;
  for (const double value : rows) finite &= std::fabs(value) <= std::numeric_limits<double>::max();
  if (finite) return;
  std::size_t i = 0;
  while (std::isfinite(rows[i])) ++i;
  throw engine::PhysicsError(std::string(message) + " row " + std::to_string(i / 3),
                             "component " + std::string(1, "xyz"[i % 3]) + " is " + std::to_string(rows[i]), advice);
}

}  // namespace

void ConnectionExchange::send_gap(std::span<const double> rows) {
  check_finite(rows, "GAP", "the motion at the interface has blown up; take a smaller step");
  connection_.send_gap(rows, engine_.current_step);
  answer_is_due_ = true;
}

bool ConnectionExchange::receive_multipliers(std::span<double> rows) {
  const bool last = connection_.receive_multipliers(rows, engine_.current_step, timeout_);
  answer_is_due_ = false;
  check_finite(rows, "MULTIPLIERS", "the coupler's solve has failed; look at its rows and masses");
  stopped_ = last;
  return !last;
}

}  // namespace gabion::protocol
