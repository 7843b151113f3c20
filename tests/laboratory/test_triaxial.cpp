#include "dem_server/laboratory/triaxial_test.hpp"
#include "dem_server/packing/homogenise.hpp"
#include "dem_server/packing/packing.hpp"
#include "tests/dem_server/fixture.hpp"

using namespace gabion::dem;
using gabion::dem::testing::Scene;

namespace {

/// Gravel of the seed study.
const GrainMaterial gravel{1.77e9, 0.35e9, 2650.0, 1.0, 1.78e5, 1.78e5};
const GrainMaterial elastic{1.77e9, 0.35e9, 2650.0, INFINITY, INFINITY, INFINITY};

PackingRequest request_of(double grains) {
  PackingRequest request;
  request.box = {vec(0, 0, 0), vec(1, 1, 1), {true, true, true}};
  const double r = std::cbrt(0.63 / grains / (4.0 / 3.0 * std::numbers::pi * 3.75));
  request.radius = {r, 2.0 * r};
  return request;
}

/// A bonded periodic sample, moved and wrapped anew.
void fill(Scene& scene, const Packing& packing, const Domain& box, const GrainMaterial& material, Vec moved = Vec{},
          int threads = 1) {
  VecField x = packing.position;
  for (Vec& place : x) {
    place += moved;
    for (int axis = 0; axis < 3; ++axis)
      place[axis] -= box.period(axis) * std::floor((place[axis] - box.lo[axis]) / box.period(axis));
  }
  scene.grains(x, packing.radius, material);
  scene.periodic_box(box.lo, box.hi);
  scene.engine.threads = threads;
  scene.engine.set_contact_options({Geometry::updated, true, 0.0});
  scene.engine.make_bonds(packing.gap);
  scene.engine.prepare();
}

double lateral(const CurvePoint& point) {
  return 0.5 * (point.lateral_stress[0] + point.lateral_stress[1]);
}

}  // namespace

TEST_CASE("isotropic compression of a face-centred cubic lattice gives its bulk modulus") {
  const auto crystal = testing::face_centred(3, 4, 3);
  Scene scene;
  scene.grains(crystal.x, crystal.r, elastic);
  scene.periodic_box(vec(-.1, -.3, -.2), vec(2.9, 3.7, 2.8));
  scene.engine.set_contact_options({Geometry::updated, true, 0.0});
  REQUIRE(scene.engine.make_bonds(1e-6).contacts_per_grain == Approx(12.0));
  scene.engine.prepare();
  // C11 + 2 C12 = sqrt(2) k_n/R with C11 = (k_n + k_s)/(sqrt(2) R), C12 = (k_n - k_s)/(2 sqrt(2) R)
  const double contact = 0.5 * elastic.normal_stiffness * crystal.r[0];
  const double bulk = std::sqrt(2.0) * contact / crystal.r[0] / 3.0;
  Confinement confinement;
  confinement.pressure = 1e-6 * bulk;
  TriaxialTest test(scene.engine, confinement);
  const CurvePoint confined = test.confine();
  const SampleState state = test.state();
  const double volume_strain = 1.0 - state.box[0] * state.box[1] * state.box[2] / 36.0;
  CHECK(confined.axial_stress == Approx(confinement.pressure).epsilon(2e-3));
  // the stress is of the step before the last strain
  CHECK(confined.axial_stress / volume_strain == Approx(bulk).epsilon(1e-4));
  CHECK(confined.contacts == Approx(12.0));
  CHECK(std::fabs(state.energy_error) < 1e-3 * state.largest_energy);
}

TEST_CASE("small strains of a periodic sample give the moduli of its homogenised bonds") {
  const PackingRequest request = request_of(600);
  const Packing packing = make_packing(request);
  const BondNetwork network = make_bond_network(packing.position, packing.radius, request.box, packing.gap,
                                                {{elastic.normal_stiffness}, {elastic.shear_stiffness}});
  const Stiffness compliance =
      homogenise(network, request.box, {request.box.lo, request.box.hi}).stiffness.inverse();
  Scene scene;
  fill(scene, packing, request.box, elastic);
  Confinement confinement;
  confinement.pressure = 100.0;
  confinement.unbalanced = 1e-5;
  TriaxialTest test(scene.engine, confinement);
  test.confine();
  Shearing shearing;
  shearing.inertial_number = 5e-5;
  shearing.damping = 0.5;
  shearing.axial_strain = 2e-6;
  shearing.record_every = 1e-6;
  const auto curve = test.shear(shearing);
  REQUIRE(curve.size() == 2);
  const double strain = curve[1].axial_strain - curve[0].axial_strain;
  const double stress = curve[1].axial_stress - curve[0].axial_stress;
  const double volume = curve[1].volume_strain - curve[0].volume_strain;
  const double poisson = -0.5 * (compliance(0, 2) + compliance(1, 2)) / compliance(2, 2);
  CHECK(stress / strain == Approx(1.0 / compliance(2, 2)).epsilon(0.01));
  CHECK(0.5 * (1.0 - volume / strain) == Approx(poisson).epsilon(0.01));
  CHECK(lateral(curve[1]) == Approx(confinement.pressure).epsilon(0.01));
}

TEST_CASE("a bonded gravel fails, dilates and keeps its lateral stress; the energy closes") {
  const PackingRequest request = request_of(500);
  const Packing packing = make_packing(request);
  Scene scene;
  fill(scene, packing, request.box, gravel);
  Confinement confinement;
  confinement.pressure = 50e3;
  TriaxialTest test(scene.engine, confinement);
  test.confine();
  Shearing shearing;
  shearing.axial_strain = 0.02;
  shearing.record_every = 2.5e-4;
  const auto curve = test.shear(shearing);
  REQUIRE(curve.size() == 80);
  double peak = 0.0;
  for (const CurvePoint& point : curve) {
    CHECK(lateral(point) == Approx(confinement.pressure).epsilon(0.05));
    peak = std::max(peak, point.axial_stress);
  }
  CHECK(curve.back().broken > 100);
  CHECK(curve.back().volume_strain < -1e-3);
  CHECK(peak > 1.1 * curve.back().axial_stress);
  const SampleState state = test.state();
  CHECK(state.work > 0.0);
  CHECK(std::fabs(state.energy_error) < 1e-3 * state.largest_energy);
}

TEST_CASE("neither the cell's place nor the number of threads change a test") {
  const PackingRequest request = request_of(200);
  const Packing packing = make_packing(request);
  const auto curve_at = [&](const GrainMaterial& material, Vec moved, int threads) {
    Scene scene;
    fill(scene, packing, request.box, material, moved, threads);
    Confinement confinement;
    confinement.pressure = 50e3;
    TriaxialTest test(scene.engine, confinement);
    std::vector<CurvePoint> curve{test.confine()};
    Shearing shearing;
    shearing.inertial_number = 1e-2;
    shearing.axial_strain = 8e-4;
    shearing.record_every = 1.6e-4;
    for (const CurvePoint& point : test.shear(shearing)) curve.push_back(point);
    return curve;
  };
  const auto once = curve_at(gravel, Vec{}, 1), twice = curve_at(gravel, Vec{}, 2);
  REQUIRE(once.size() == 6);
  REQUIRE(once.back().broken > 0);
  for (std::size_t k = 0; k < once.size(); ++k) {
    CHECK(once[k].axial_stress == twice[k].axial_stress);
    CHECK(once[k].volume_strain == twice[k].volume_strain);
  }
  // breakage and the sign in local damping multiply round-off: bonds that hold, and a millionth
  const auto here = curve_at(elastic, Vec{}, 1), there = curve_at(elastic, vec(0.31, -0.47, 0.6), 1);
  REQUIRE(here.size() == there.size());
  for (std::size_t k = 0; k < here.size(); ++k) {
    CHECK(there[k].axial_stress == Approx(here[k].axial_stress).epsilon(1e-6));
    CHECK(there[k].volume_strain == Approx(here[k].volume_strain).epsilon(1e-6).margin(1e-12));
  }
}

TEST_CASE("what cannot be tested is refused") {
  const PackingRequest request = request_of(100);
  const Packing packing = make_packing(request);
  Scene scene;
  fill(scene, packing, request.box, gravel);
  Confinement confinement;
  CHECK_THROWS_AS(TriaxialTest(scene.engine, confinement), gabion::engine::RequestError);  // no pressure
  confinement.pressure = 1e4;
  TriaxialTest test(scene.engine, confinement);
  CHECK_THROWS_AS(test.shear(Shearing{}), gabion::engine::RequestError);  // not confined
  CHECK_THROWS_AS(scene.engine.checkpoint(), gabion::engine::RequestError);
  Scene open;
  fill(open, packing, request.box, gravel);
  open.engine.options.periodic[1] = false;
  open.engine.prepare();
  CHECK_THROWS_AS(TriaxialTest(open.engine, confinement), gabion::engine::RequestError);
}
