#pragma once
// What the tests of elements of several rates share: a bar of graded rates, and steps with their numbers.

#include <catch2/catch.hpp>

#include "solid_fixture.hpp"

namespace gabion::continuum {

using Bytes = std::vector<std::uint8_t>;

inline const SolidMaterial soil = isotropic(1e6, 0.3, 1000.0);

/// Rates along x: 1 for the first `fine` elements, then `layers` each of 2, 4 ... up to the largest.
inline Bytes graded_rates(int nx, int others, int fine, int layers, int largest) {
  Bytes rate;
  for (int e = 0; e < nx * others; ++e) {
    const int x = e % nx;
    rate.push_back(static_cast<std::uint8_t>(x < fine ? 1 : std::min(largest, 2 << ((x - fine) / layers))));
  }
  return rate;
}

/// A bar with some distorted elements, its nodes numbered for the rates.
struct Bar {
  Bytes rate;
  Mesh mesh;
  Bar(int nx, int side, int fine, int layers, int largest, double distortion = 0.0)
      : rate(graded_rates(nx, side * side, fine, layers, largest)), mesh(box_mesh({nx, side, side}, engine::vec(nx, side, side))) {
    if (distortion > 0.0) {
      Mesh moved = mesh;
      distort(moved, distortion);
      for (std::size_t n = 0; n < mesh.nodes.size(); ++n)
        if (mesh.nodes[n][1] > 1.5) mesh.nodes[n] = moved.nodes[n];
    }
    number_by_rates(mesh, rate);
  }
};

/// Steps with their numbers; returns the ledger of the last step that is a multiple of the period.
inline engine::Ledger run_at_rates(Solid& solid, int steps, double dt, int first = 0) {
  const int period = static_cast<int>(solid.engine.period());
  engine::Ledger ledger;
  for (int k = first; k < first + steps; ++k) {
    const bool measure = k == first + steps - period;
    solid.engine.step({k * dt, dt, 0.0, measure, static_cast<std::uint64_t>(k)}, solid.nobody);
    if (measure) ledger = solid.engine.ledger();
  }
  return ledger;
}

inline double entry(const engine::Ledger& ledger, const std::string& name) {
  for (const auto& e : ledger.entries)
    if (e.name == name) return e.energy;
  FAIL("no entry " << name);
  return 0.0;
}

}  // namespace gabion::continuum
