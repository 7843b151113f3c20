// The same test with what a contact or a grain may have beyond springs and friction: nothing in it knows of them.

#include "dem_server/laboratory/triaxial_test.hpp"
#include "dem_server/packing/packing.hpp"
#include "tests/dem_server/fixture.hpp"

using namespace gabion::dem;
using gabion::dem::testing::Scene;

namespace {

GrainMaterial gravel() {
  GrainMaterial material;
  material.normal_stiffness = 1.77e9;
  material.shear_stiffness = 0.35e9;
  material.density = 2650.0;
  material.friction = 1.0;
  material.normal_strength = material.shear_strength = 1.78e5;
  return material;
}

GrainMaterial unbreakable() {
  GrainMaterial material = gravel();
  material.friction = material.normal_strength = material.shear_strength = INFINITY;
  return material;
}

/// Largest change of a distance between two members of a clump, over the mean radius.
double deformation(const DemEngine& engine, const VecField& places) {
  double largest = 0.0;
  const VecField &x = engine.motion.position, &u = engine.motion.displacement;
  for (std::size_t b = 0; b < engine.clumps().size(); ++b) {
    const auto members = engine.clumps().members(b);
    for (std::size_t k = 1; k < members.size(); ++k) {
      const auto i = members[k - 1], j = members[k];
      // in periods: the cell has changed, and members may lie on both of its sides
      const Domain box = engine.domain();
      Vec now = box.shift(x[j] + u[j] - x[i] - u[i]), then = places[j] - places[i];
      for (int axis = 0; axis < 3; ++axis) then[axis] -= std::nearbyint(then[axis]);
      largest = std::max(largest, std::fabs(norm(now) - norm(then)));
    }
  }
  return largest / engine.grains().mean_radius();
}

struct Result {
  double clump_deformation = 0.0;
  std::vector<CurvePoint> curve;
  SampleState state;
  double deviator() const {
    const CurvePoint& p = curve.back();
    return p.axial_stress - 0.5 * (p.lateral_stress[0] + p.lateral_stress[1]);
  }
};

Result tested(const GrainMaterial& material, unsigned clump_size, double strain, Vec moved = Vec{}) {
  PackingRequest request;
  request.box = {vec(0, 0, 0), vec(1, 1, 1), {true, true, true}};
  const double r = std::cbrt(0.63 / 300.0 / (4.0 / 3.0 * std::numbers::pi * 3.75));
  request.radius = {r, 2.0 * r};
  const Packing packing = make_packing(request);
  VecField x = packing.position;
  for (Vec& place : x) place += moved;  // not wrapped: clumps are grouped in the order of the places
  Scene scene;
  scene.grains(x, packing.radius, material);
  scene.periodic_box(request.box.lo, request.box.hi);
  scene.engine.set_contact_options({Geometry::updated, true, 0.0});
  if (clump_size > 1) {
    ClumpRequest clumps;
    clumps.sizes = {static_cast<std::int32_t>(clump_size)};
    clumps.gap = packing.gap;
    REQUIRE(scene.engine.make_clumps(clumps).clumps > 40);
  }
  scene.engine.make_bonds(packing.gap);
  scene.engine.prepare();
  Confinement confinement;
  confinement.pressure = 50e3;
  TriaxialTest test(scene.engine, confinement);
  Result result;
  result.curve.push_back(test.confine());
  Shearing shearing;
  shearing.axial_strain = strain;
  shearing.record_every = 0.2 * strain;
  for (const CurvePoint& point : test.shear(shearing)) result.curve.push_back(point);
  result.state = test.state();
  result.clump_deformation = deformation(scene.engine, x);
  return result;
}

void check_energy(const Result& result) {
  CHECK(result.state.work > 0.0);
  CHECK(std::fabs(result.state.energy_error) < 1e-3 * result.state.largest_energy);
}

}  // namespace

TEST_CASE("rolling resistance makes a sample stronger, and the energy closes") {
  GrainMaterial rolling = gravel();
  rolling.rolling_stiffness = 1.0;
  rolling.rolling_friction = 0.3;
  const Result with = tested(rolling, 1, 0.02), without = tested(gravel(), 1, 0.02);
  check_energy(with);
  CHECK(with.deviator() > 1.15 * without.deviator());
}

TEST_CASE("a restitution below 1 is known to the test, and the energy closes") {
  GrainMaterial damped = gravel();
  damped.restitution = 0.5;
  check_energy(tested(damped, 1, 0.01));
}

TEST_CASE("grains that may not turn make a sample stronger, and the energy closes") {
  GrainMaterial locked = gravel();
  locked.rotates = false;
  const Result with = tested(locked, 1, 0.02), without = tested(gravel(), 1, 0.02);
  check_energy(with);
  CHECK(with.deviator() > 1.3 * without.deviator());
}

TEST_CASE("clumps keep their shape, make a sample stronger, and the energy closes") {
  const Result with = tested(gravel(), 4, 0.02), without = tested(gravel(), 1, 0.02);
  check_energy(with);
  CHECK(with.clump_deformation < 1e-9);
  CHECK(with.deviator() > 1.2 * without.deviator());
}

TEST_CASE("with clumps, too, the cell's place does not matter") {
  const Result here = tested(unbreakable(), 4, 2e-4), there = tested(unbreakable(), 4, 2e-4, vec(0.31, -0.47, 0.6));
  for (std::size_t k = 0; k < here.curve.size(); ++k) {
    CHECK(there.curve[k].axial_stress == Approx(here.curve[k].axial_stress).epsilon(1e-6));
    CHECK(there.curve[k].volume_strain == Approx(here.curve[k].volume_strain).epsilon(1e-6).margin(1e-12));
  }
}
