#pragma once
// Triaxial test of a periodic sample with the engine's own contacts; the messages TRIAXIAL_CONFINE,
// TRIAXIAL_SHEAR and TRIAXIAL_CURVE.
//
// confine: all three axes under a servo until the pressure stands and the grains are at rest.
// shear: the axis is shortened at a rate, the two others stay under the servo.
//
//   sigma = 1/V sum over contacts of f (x) branch       mean stress [Pa]; here compression is positive
//   I     = rate d sqrt(rho/p)                           inertial number (GDR MiDi 2004)
//   W     = sum over steps of V sigma : E                work of the cell [J], in halves at both ends of a step
//
//   d mean diameter by number [m]   rho density of the grains [kg/m3]   p confinement [Pa]

#include <array>
#include <optional>
#include <vector>

#include "dem_server/engine.hpp"
#include "dem_server/laboratory/servo.hpp"

namespace gabion::dem {

struct Confinement {
  double pressure = 0.0;             ///< Pa, above 0
  int axis = 2;                      ///< of the later shear
  double damping = 0.7;              ///< local
  double unbalanced = 1e-3;          ///< at rest below this mean unbalanced force over the mean contact force
  std::uint64_t most_steps = 200000; ///< then the state is taken as it is, if the stresses stand
  double step_fraction = 0.7;        ///< of the stable step, over sqrt(1 + damping)
};

struct Shearing {
  double axial_strain = 0.0;      ///< goes on until here, compression positive, over the length when confined
  double record_every = 1e-3;     ///< axial strain between two points of the curve
  double inertial_number = 1e-3;  ///< gives the rate
  double damping = 0.2;           ///< local
};

/// Means over the steps since the point before; counts as they stand.
struct CurvePoint {
  double axial_strain = 0.0;         ///< compression positive, over the length when confined
  double volume_strain = 0.0;        ///< compression positive
  double axial_stress = 0.0;         ///< Pa, compression positive
  double lateral_stress[2] = {0, 0};  ///< Pa
  double broken = 0.0;               ///< bonds since the start
  double contacts = 0.0;             ///< bonded or touching, per grain
  double sliding = 0.0;              ///< share of the contacts
};

/// How the sample stands, and what has been done to it.
struct SampleState {
  Vec box{};                    ///< sides, m
  Vec stress{};                 ///< normal stresses x y z, compression positive, Pa
  double step = 0.0;            ///< dt, s
  std::uint64_t steps = 0;      ///< since the test began
  double unbalanced = 0.0;      ///< mean unbalanced force over mean contact force
  double work = 0.0;            ///< of the cell, J
  double energy_error = 0.0;    ///< of stored plus lost less work since the beginning, J; 0 when energy is not measured
  double largest_energy = 0.0;  ///< largest |stored|, |lost| or |work| so far, J
};

class TriaxialTest {
 public:
  /// Needs a prepared engine whose ground is periodic in every direction; see DemEngine::allow_stretch. The sample is
  /// taken as it stands, and the engine must not be stepped by anybody else. Throws engine::RequestError.
  TriaxialTest(DemEngine& engine, const Confinement& confinement);

  /// Throws engine::PhysicsError when the pressure is not reached.
  CurvePoint confine();
  /// May be called again to go on. Throws engine::RequestError for values that make no sense.
  std::vector<CurvePoint> shear(const Shearing& request);
  SampleState state();

 private:
  struct Sums;

  void check(const Shearing& request) const;
  void choose_step(double damping);
  void step(double damping, bool measure);
  Vec pressure() const;
  Vec affine_stiffness() const;
  double mean_rate(double inertial_number) const;
  double volume() const;
  void apply(Vec rate);
  void add_counts(CurvePoint& point) const;
  void measure_energy();

  DemEngine& engine_;
  Confinement confinement_;
  int lateral_[2];
  double density_ = 0.0;  ///< mean, kg/m3
  double dt_ = 0.0, time_ = 0.0;
  std::uint64_t steps_ = 0;
  std::optional<Servo> servo_;
  bool confined_ = false;
  Vec box_{};           ///< sides when confined, m
  double rate_ = 0.0;   ///< axial, shortening positive, 1/s
  double axial_ = 0.0;  ///< axial strain so far
  Vec strain_{};        ///< of the last step
  engine::Work work_;
  std::optional<double> first_balance_;
  double error_ = 0.0, largest_energy_ = 0.0;
};

}  // namespace gabion::dem
