#include <catch2/catch.hpp>

#include "dem_server/packing/face_offset.hpp"
#include "protocol/engine/engine.hpp"
#include "tests/packing/lattices.hpp"

using namespace gabion::dem;

namespace {

const StiffnessCoefficients coefficients{{3.8}, {1.1}};

/// Periodic sideways, free at both ends along z.
lattice::Lattice column() {
  lattice::Lattice crystal = lattice::face_centred_cubic(4, true);
  crystal.box.periodic[2] = false;
  return crystal;
}

/// The grains of the lowest or highest layer, as a face a distance beyond their centres that holds them.
HeldFace end_of(const lattice::Lattice& crystal, bool high, double beyond, std::uint8_t components) {
  const double z = crystal.side * (high ? 3.75 : 0.25);
  HeldFace face{.axis = 2, .high = high, .place = high ? z + beyond : z - beyond, .grains = {}, .components = components};
  for (std::size_t g = 0; g < crystal.centres.size(); ++g)
    if (std::fabs(crystal.centres[g][2] - z) < 1e-9) face.grains.push_back(static_cast<std::int32_t>(g));
  return face;
}

/// Spheres of diameter 1 in a row along z, stiffness 1 but for the first bond.
BondNetwork chain(double first_bond) {
  constexpr int spheres = 20;
  VecField centres;
  for (int k = 0; k < spheres; ++k) centres.push_back(gabion::engine::vec(5, 5, k));
  const std::vector<double> radii(spheres, 0.5);
  BondNetwork network = make_bond_network(centres, radii, {}, 1e-6, {{4.0}, {4.0}});
  for (Bond& bond : network.bonds) bond.k_n = std::min(bond.i, bond.j) == 0 ? first_bond : 1.0;
  return network;
}

const Domain chain_domain{gabion::engine::vec(0, 0, 0), gabion::engine::vec(10, 10, 20), {true, true, false}};
const Window chain_window{gabion::engine::vec(0, 0, 4.5), gabion::engine::vec(10, 10, 15.5)};

}  // namespace

TEST_CASE("a lattice held at its outermost centres: the face is as far inside as they are") {
  const lattice::Lattice crystal = column();
  const BondNetwork network = make_bond_network(crystal.centres, crystal.radii, crystal.box, 1e-6, coefficients);
  const Window window{crystal.box.lo + splat(crystal.side) * gabion::engine::vec(0, 0, 1),
                      crystal.box.hi - splat(crystal.side) * gabion::engine::vec(0, 0, 1)};
  for (const bool high : {false, true})
    for (const double beyond : {0.0, 0.3, -0.2})
      for (const std::uint8_t components : {4, 7}) {
        const FaceOffset found = face_offset(network, crystal.box, end_of(crystal, high, beyond, components), window, {});
        CHECK(found.converged);
        CHECK(found.offset == Approx(beyond).margin(1e-8));
      }
}

TEST_CASE("a soft or stiff bond at the face moves it out or in by the length it gives way more or less") {
  for (const double first : {0.25, 0.5, 1.0, 4.0}) {
    const HeldFace face{.axis = 2, .high = false, .place = 0.0, .grains = {0}, .components = 4};
    CHECK(face_offset(chain(first), chain_domain, face, chain_window, {}).offset == Approx(1.0 - 1.0 / first).margin(1e-8));
  }
}

TEST_CASE("a face that says nothing is refused") {
  const BondNetwork network = chain(1.0);
  const HeldFace sound{.axis = 2, .high = false, .place = 0.0, .grains = {0}, .components = 4};
  const auto refused = [&](HeldFace face, const Window& window) {
    CHECK_THROWS_AS(face_offset(network, chain_domain, face, window, {}), gabion::engine::RequestError);
  };
  HeldFace face = sound;
  face.grains.clear();
  refused(face, chain_window);
  face = sound;
  face.components = 3;  // holds both tangents, not the normal
  refused(face, chain_window);
  face = sound;
  face.grains = {20};
  refused(face, chain_window);
  refused(sound, {chain_window.lo, gabion::engine::vec(10, 10, 8.5)});  // four grains
}
