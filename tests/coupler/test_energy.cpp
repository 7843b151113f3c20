// The balance of both ledgers: its error, what a released body brings, and what stands beside it.

#include <catch2/catch.hpp>
#include <cmath>

#include "coupler/run/energy.hpp"

using gabion::coupler::EnergyBalance;
using gabion::protocol::RunDone;

namespace {

RunDone report(std::vector<std::string> names, std::vector<double> energies) {
  RunDone done;
  done.ledger_names = std::move(names);
  done.ledger = std::move(energies);
  return done;
}

RunDone mesh(double kinetic, double loads, double swing) { return report({"kinetic", "elastic", "damping", "loads", "rate_swing"}, {kinetic, 2.0, 1.0, loads, swing}); }

}  // namespace

TEST_CASE("the balance is what is stored and lost less the work, of both ledgers") {
  EnergyBalance balance;
  const RunDone grains = report({"kinetic", "friction", "multipliers"}, {3.0, 0.5, 0.25});
  balance.add(grains, mesh(5.0, 1.0, 0.0));
  CHECK(balance.error() == 0.0);
  balance.add(grains, mesh(6.0, 2.0, 0.0));  // the load's work
  CHECK(balance.error() == Approx(0.0).margin(1e-15));
  balance.add(grains, mesh(6.5, 2.0, 0.0));
  CHECK(balance.error() == Approx(0.5 / 11.5));
  CHECK(balance.dissipated() == Approx(1.5));
  balance.body_added();
  balance.add(grains, mesh(106.5, 2.0, 0.0));  // what a released body brings is no error
  CHECK(balance.error() == Approx(0.5 / 111.5));
}

TEST_CASE("rate_swing stands beside the balance, and has an error of its own") {
  EnergyBalance balance;
  balance.add({}, mesh(5.0, 1.0, 0.0));
  balance.add({}, mesh(4.2, 1.0, 0.7));  // a wave that went over into coarser elements
  CHECK(balance.error() == Approx(0.8 / 7.0));
  CHECK(balance.excursion() == Approx(0.8 / 7.0));
  CHECK(balance.error_with_swing() == Approx(0.1 / 7.0));
  CHECK(balance.excursion_with_swing() == Approx(0.1 / 7.0));
  EnergyBalance resumed;
  resumed.restore(balance.state());
  resumed.add({}, mesh(4.0, 1.0, 0.7));
  CHECK(resumed.error_with_swing() == Approx(0.3 / 7.0));
  resumed.add({}, mesh(std::nan(""), 1.0, 0.7));  // is beyond every tolerance
  CHECK_FALSE(std::isfinite(resumed.error()));
  CHECK_FALSE(std::isfinite(resumed.error_with_swing()));
}
