#include <algorithm>
#include <catch2/catch.hpp>
#include <cstring>
#include <numbers>

#include "dem_server/packing/bond_network.hpp"
#include "dem_server/packing/homogeneity.hpp"
#include "dem_server/packing/packing.hpp"
#include "dem_server/packing/relaxation.hpp"
#include "protocol/engine/engine.hpp"

using namespace gabion::dem;
using gabion::engine::RequestError;

namespace {

PackingRequest request_for(double grains, double solid_fraction, bool periodic) {
  PackingRequest request;
  request.box.hi = vec(3.0, 3.0, 3.0);
  for (bool& p : request.box.periodic) p = periodic;
  request.solid_fraction = solid_fraction;
  // radii r to 2 r: mean volume 4/3 pi 3.75 r^3
  const double r = std::cbrt(27.0 * solid_fraction / grains / (4.0 / 3.0 * std::numbers::pi * 3.75));
  request.radius = {r, 2.0 * r};
  return request;
}

bool same_bits(const Packing& a, const Packing& b) {
  return a.radius.size() == b.radius.size() && a.gap == b.gap &&
         std::memcmp(a.radius.data(), b.radius.data(), a.radius.size() * sizeof(double)) == 0 &&
         std::memcmp(a.position.data(), b.position.data(), a.position.size() * sizeof(Vec)) == 0;
}

/// Largest overlap, found anew, m.
double deepest_overlap(const Packing& packing, const Domain& box) {
  double deepest = 0.0;
  for (const Pair& pair : find_pairs(packing.position, packing.radius, 0.0, box))
    deepest = std::max(deepest, packing.radius[pair.i] + packing.radius[pair.j] -
                                    norm(packing.position[pair.j] + box.offset(pair.image) - packing.position[pair.i]));
  return deepest;
}

}  // namespace

TEST_CASE("the same seed gives the same bits, another seed another packing") {
  PackingRequest request = request_for(600, 0.62, true);
  const Packing first = make_packing(request);
  CHECK(same_bits(first, make_packing(request)));
  request.seed = 2;
  CHECK_FALSE(same_bits(first, make_packing(request)));
}

TEST_CASE("a periodic packing meets solid fraction and contacts without overlaps") {
  const PackingRequest request = request_for(1500, 0.62, true);
  const Packing packing = make_packing(request);
  CHECK(packing.solid_fraction == Approx(0.62).epsilon(1e-10));
  CHECK(packing.box_fraction == Approx(0.62).epsilon(1e-10));
  CHECK(packing.contacts_per_grain == Approx(5.7).margin(2e-3));
  CHECK(packing.residual_overlap < 1e-6);
  const double mean_radius = 0.5 * (request.radius[0] + request.radius[1]);
  CHECK(deepest_overlap(packing, request.box) == Approx(packing.max_overlap * mean_radius).epsilon(5e-3));
  CHECK(packing.max_overlap < 1e-4);
  CHECK(packing.gap > 0.0);
  for (const Vec x : packing.position)
    for (int a = 0; a < 3; ++a) CHECK((x[a] >= 0.0 && x[a] < 3.0));
  // The message's gap rebuilds the network that was counted, and no grain of it is a rattler
  const BondNetwork network =
      make_bond_network(packing.position, packing.radius, request.box, packing.gap, {{1.0}, {1.0}});
  CHECK(network.contacts_per_grain() == Approx(packing.contacts_per_grain).epsilon(1e-12));
  std::vector<unsigned> contacts(packing.radius.size(), 0);
  for (const Bond& bond : network.bonds) {
    ++contacts[bond.i];
    ++contacts[bond.j];
  }
  CHECK(*std::min_element(contacts.begin(), contacts.end()) >= request.min_contacts);
}

TEST_CASE("without a least number of contacts no grain is removed, and the volume is exact") {
  PackingRequest request = request_for(1000, 0.62, true);
  const Packing without_rattlers = make_packing(request);
  request.min_contacts = 0;
  const Packing all = make_packing(request);
  CHECK(all.rattlers == 0);
  CHECK(without_rattlers.rattlers > 0);
  CHECK(without_rattlers.radius.size() + without_rattlers.rattlers == all.radius.size());
  double solid = 0.0;
  for (const double r : all.radius) solid += 4.0 / 3.0 * std::numbers::pi * r * r * r;
  CHECK(solid / 27.0 == Approx(0.62).epsilon(1e-10));
}

TEST_CASE("grains stay wholly inside flat faces and reach them") {
  PackingRequest request = request_for(1200, 0.60, false);
  request.box.periodic[0] = true;
  const Packing packing = make_packing(request);
  std::size_t at_floor = 0;
  for (std::size_t g = 0; g < packing.radius.size(); ++g)
    for (int a = 1; a < 3; ++a) {
      const double below = packing.position[g][a] - packing.radius[g];
      CHECK(below >= 0.0);
      CHECK(packing.position[g][a] + packing.radius[g] <= 3.0);
      if (a == 2 && below < 0.1 * packing.radius[g]) ++at_floor;
    }
  // About one grain a cross-section of a mean diameter squared would be a full layer
  const double diameter = request.radius[0] + request.radius[1];
  CHECK(static_cast<double>(at_floor) > 0.4 * 9.0 / (diameter * diameter));
  CHECK(packing.box_fraction < packing.solid_fraction);
  CHECK(packing.solid_fraction == Approx(0.60).epsilon(0.02));
}

TEST_CASE("above jamming the remaining overlap is reported, and overlapping grains are bonded") {
  const PackingRequest request = request_for(800, 0.67, true);
  const Packing packing = make_packing(request);
  CHECK(packing.solid_fraction == Approx(0.67).epsilon(1e-10));
  CHECK(packing.residual_overlap > 1e-3);
  CHECK(packing.residual_overlap < 0.05);
  CHECK(packing.gap == 0.0);
  CHECK(packing.contacts_per_grain > 5.7);
}

TEST_CASE("a packing is even and isotropic") {
  const PackingRequest request = request_for(2000, 0.63, true);
  const Packing packing = make_packing(request);
  for (int axis = 0; axis < 3; ++axis) {
    const std::vector<double> slices = slice_fractions(packing.position, packing.radius, request.box, axis, 4);
    const auto [low, high] = std::minmax_element(slices.begin(), slices.end());
    CHECK(*high - *low < 0.03);  // of about 0.61: rattlers are missing at random
  }
  // n n^T of N random directions scatters by sqrt(4/45/N); four standard deviations
  const auto fabric = fabric_tensor(packing.position, packing.radius, request.box, packing.gap);
  const double bonds = 0.5 * packing.contacts_per_grain * static_cast<double>(packing.radius.size());
  for (int k = 0; k < 6; ++k)
    CHECK(fabric[k] == Approx(k < 3 ? 1.0 / 3.0 : 0.0).margin(4.0 * std::sqrt(4.0 / 45.0 / bonds)));
}

TEST_CASE("relaxation parts two overlapping spheres along their line of centres") {
  VecField centres{vec(1.0, 1.0, 1.0), vec(2.14, 2.52, 1.0)};  // distance 1.9, radii 1 and 1
  const std::vector<double> radii{1.0, 1.0};
  Domain box{vec(-10, -10, -10), vec(10, 10, 10), {false, false, false}};
  Relaxation relaxation(centres, radii, box);
  const RelaxationOutcome outcome = relaxation.run(1.0, {2000, 1e-8, 0.0});
  CHECK(outcome.mean_overlap < 1e-8);
  const Vec d = centres[1] - centres[0];
  CHECK(norm(d) == Approx(2.0).epsilon(1e-2));
  CHECK(norm(d) >= 2.0 - 1e-7);
  CHECK(d[0] / norm(d) == Approx(0.6).epsilon(1e-12));
  CHECK(d[1] / norm(d) == Approx(0.8).epsilon(1e-12));
}

TEST_CASE("requests that make no sense are refused with the field") {
  PackingRequest request = request_for(600, 0.62, true);
  const auto refused_for = [](PackingRequest bad) {
    try {
      make_packing(bad);
    } catch (const RequestError& e) {
      return e.where;
    }
    return std::string("accepted");
  };
  PackingRequest bad = request;
  bad.solid_fraction = 0.9;
  CHECK(refused_for(bad) == "PACK solid_fraction");
  bad = request;
  bad.box.hi[1] = 0.2;
  CHECK(refused_for(bad) == "PACK box");
  bad = request;
  bad.radius = {};
  CHECK(refused_for(bad) == "PACK radius");
  bad = request;
  bad.contacts_per_grain = -1.0;
  CHECK(refused_for(bad) == "PACK contacts_per_grain");
}
