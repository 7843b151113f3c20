#pragma once
// Explicit linear elasticity on hexahedra: the engine behind continuum_server. Set up with set_mesh,
// set_materials and the members of engine::Engine, then prepare(); no sockets, no files.
//
//   M v' = body + loads - K u - dashpots - local damping + multipliers,   small displacements
//
//   K     condensed element stiffness times (1 - w) at the element's centre: see brick.hpp, hexahedron.hpp
//   M     lumped: (1 - w) rho V/8 per corner of a brick, row sums otherwise, kg
//   body  integral of (1 - w) rho N_J over each element times gravity, w at the Gauss points, N
//
// Fields: displacement, velocity, force, tie_force, position [n,3]; mass, plain_mass [n]; stress, strain [m,6] at
// the elements' centres, Voigt xx yy zz yz zx xy, engineering shears, without weight; element_weight [m], 1 - w.
// Unbalanced measure: mean over nodes of the total force over the mean over element corners of the elastic force.

#include <functional>

#include "continuum_server/element_forces.hpp"
#include "protocol/engine/engine.hpp"

namespace gabion::continuum {

class ContinuumEngine : public engine::Engine {
 public:
  /// Starts afresh, at rest: motion, groups and tie of before are gone. prepare() says where the mesh does not
  /// make sense.
  void set_mesh(Mesh mesh);
  void set_materials(std::vector<SolidMaterial> materials);
  /// The rate of each element, see rates.hpp; empty: all elements take every step. Call after prepare(), which keeps
  /// them, as stable_step() heeds them. RequestError: rates that make no sense for the mesh and the tie.
  void set_rates(std::span<const std::uint8_t> rate);

  /// Keeps the motion when it is called again for the same mesh. RequestError: mesh or material that makes
  /// no sense, inverted element.
  void prepare() override;
  /// With several rates, the step of the run at which each element is at its own limit.
  double stable_step() override;
  std::uint64_t period() const override { return rates_.rate.back(); }
  /// PhysicsError: a velocity that is not finite; at measured steps an element turned inside out. A new set of
  /// constraints or dashpots takes effect with prepare(), stable_step() or a new step size.
  bool step(const engine::StepContext& context, engine::Exchange& exchange) override;
  /// PhysicsError: a velocity that is not finite, an element turned inside out at any of its eight corners.
  void check_health() const override;

  engine::Ledger ledger() const override;
  std::vector<engine::NamedCount> counters() const override;
  double unbalanced() const override;
  std::optional<std::vector<double>> field(const std::string& name, std::vector<std::uint64_t>& shape) const override;
  void set_field(const std::string& name, std::span<const double> values) override;
  std::uint64_t state_hash() const override;
  std::vector<std::uint8_t> checkpoint() const override;
  void restore(std::span<const std::uint8_t> blob) override;

  /// Names that field() knows.
  static std::vector<std::string> field_names();

  /// 24 x 24 as the step applies it, with the weight; row 3 corner + axis, N/m.
  ElementStiffness element_stiffness(std::size_t element) const { return forces_.stiffness(element); }
  const Mesh& mesh() const { return mesh_; }

 private:
  // set-up, in the order of prepare()
  void check_shapes() const;
  void weigh_elements();
  void sum_masses();
  void add_body_loads();

  // parts of a step
  bool step_at_rates(const engine::StepContext& context, engine::Exchange& exchange);
  void add_outer_forces(const engine::StepContext& context, std::size_t first, std::size_t last);
  VecField present_forces() const;
  void adapt(const engine::StepContext& context);
  void book_step_change(double dt);
  void measure_stored_energy();
  void measure_rate_swing(double dt);
  void book_step_change_at_rates(const engine::StepContext& context);
  struct NextImpulse {
    VecField of_all, of_loads;
  };
  NextImpulse next_impulse() const;
  void bring_velocities(const NextImpulse& before);

  Corners corners_now(std::size_t element) const;
  std::vector<double> centre_strains() const;
  Vec edges() const { return options.box_hi - options.box_lo; }

  Mesh mesh_;
  std::vector<SolidMaterial> materials_;
  std::vector<double> share_;  ///< 1 - w per element
  VecField body_;              ///< body load, N; empty without gravity
  ElementForces forces_;
  Rates rates_;
  bool prepared_ = false;

  // what the last adapt() was for
  double step_size_ = 0.0;
  std::size_t reach_ = 0;
  int arranged_threads_ = 1;
  double time_ = 0.0;  ///< t_n of the last step, s

  // at t_n of the last measured step, J
  double kinetic_ = 0.0, elastic_ = 0.0, gravity_ = 0.0;
  double rate_swing_ = 0.0;   ///< see measure_rate_swing
  VecField mean_velocity_;    ///< its working space, empty at one rate
  double past_step_ = 0.0;    ///< of the last drift, s; 0: none since the velocities were set
  double step_change_ = 0.0;  ///< lost where the step changed, J; see book_step_change
};

}  // namespace gabion::continuum
