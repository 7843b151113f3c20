#pragma once
// The discrete-element engine: bonded or frictional spheres, walls and the rigid block, behind the
// interface that every engine has. Knows of no sockets, files or scenes.
//
// Order of calls: set_grains, set_materials, set_contact_options, make_bonds, set_walls, set_block,
// boundary.add, prepare, then stable_step and step. Setting grains, materials, options or bonds again
// rebuilds the contacts at the next prepare; walls, block and boundary may change between runs.

#include <memory>

#include "dem_server/block.hpp"
#include "dem_server/clumps.hpp"
#include "dem_server/contact_forces.hpp"
#include "dem_server/linear_network.hpp"
#include "dem_server/rotation.hpp"
#include "dem_server/sponge.hpp"
#include "dem_server/walls.hpp"
#include "protocol/engine/engine.hpp"

namespace gabion::dem {

enum class Geometry {
  frozen,  ///< normals, branches and list stay as built; forces linear; bonds that cannot break only
  updated  ///< contacts follow the grains, new ones form
};

struct ContactOptions {
  Geometry geometry = Geometry::updated;
  bool rotations = true;
  double skin = 0.0;  ///< search margin over the mean radius, at least 0; 0 takes the default
};

struct Bonded {
  std::uint64_t bonds;
  double contacts_per_grain;
};

class DemEngine : public engine::Engine {
 public:
  DemEngine();
  ~DemEngine() override;

  // Set-up. Each throws engine::RequestError for values that make no sense.

  void set_grains(VecField position, std::vector<double> radius, std::vector<std::int32_t> material);
  void set_materials(std::vector<GrainMaterial> materials);
  void set_contact_options(const ContactOptions& contact_options);
  /// Bonds every pair whose gap is at most gap times the sum of the radii, instead of earlier bonds;
  /// stress-free at the rest positions. Needs the grains and the options' box.
  Bonded make_bonds(double gap);
  /// Joins touching spheres to rigid clumps, instead of earlier ones; members lose the bonds among them. Needs the
  /// grains and the options' box; bonds made before earlier clumps must be made again.
  Clumped make_clumps(const ClumpRequest& request);
  void set_walls(std::vector<Wall> walls);
  void set_block(const BlockSetup& setup);
  /// See Sponge::set; call after prepare.
  void set_sponge(std::vector<std::int32_t> grains, std::vector<double> beta, std::size_t hats,
                  const std::vector<std::int32_t>& row_ptr, const std::vector<std::int32_t>& columns,
                  const std::vector<double>& values);

  // A ground that is periodic in every direction may be strained between steps (stretch.cpp).

  /// From here on contacts know the strain and virial() is kept. Call after prepare, which ends it when it builds
  /// the contacts anew. Throws RequestError where the ground cannot be strained.
  void allow_stretch();
  bool stretched() const { return contact_.stretched; }
  /// Maps the box and the grains, contacts included, by x -> x + strain (x - centre), along x, y, z. At most once
  /// after each step; velocities and displacements stay those beyond the homogeneous motion.
  void stretch(Vec strain);
  /// Sum over contacts of the force on i times the branch from its body to that of j, by components x, y, z, at the forces of the
  /// last step: the volume times the mean normal stresses, tension positive, N m.
  Vec virial() const { return contact_.virial; }

  // engine::Engine

  void prepare() override;
  double stable_step() override;
  bool step(const engine::StepContext& context, engine::Exchange& exchange) override;
  engine::Ledger ledger() const override { return ledger_; }
  std::vector<engine::NamedCount> counters() const override;
  double unbalanced() const override;
  /// Names: field_names(). contact has rows i, j, nx, ny, nz, fx, fy, fz (force on i, N); shear as of the
  /// last step. block: see Block::state.
  std::optional<std::vector<double>> field(const std::string& name, std::vector<std::uint64_t>& shape) const override;
  void set_field(const std::string& name, std::span<const double> values) override;
  std::uint64_t state_hash() const override;
  std::vector<std::uint8_t> checkpoint() const override;
  void restore(std::span<const std::uint8_t> blob) override;

  void check_health() const override { check_motion(); }

  // For tests, the packing and the session

  static std::vector<std::string> field_names();
  /// Linear momentum, angular momentum about the origin (spins and block included), sum of m |v|.
  std::vector<double> momentum() const override;
  const Grains& grains() const { return grains_; }
  const ContactTable& contacts() const { return contact_.table; }
  const std::vector<Pair>& bonds() const { return bonds_; }
  /// Whether the grain may rotate, boundary groups apart.
  bool rotates(std::size_t grain) const {
    return contact_options_.rotations && grains_.material_of(grain).rotates;
  }
  Domain domain() const;
  const Rotation& rotation() const { return rotation_; }
  const Block& block() const { return block_; }
  const Clumps& clumps() const { return clumps_; }
  const Walls& walls() const { return walls_; }
  const engine::Work& sponge_work() const { return sponge_.work; }
  /// Search margin, m.
  double skin() const { return skin_; }

 private:
  friend struct EngineState;  // checkpoint

  // set-up (prepare.cpp)
  void check_setup() const;
  bool needs_building() const;
  VecField present_positions() const;
  void build_contacts();
  void set_masses();
  void hold_rotations();
  std::uint64_t rotation_groups() const;
  void find_surfaces();
  void refuse_overlaps() const;
  void refuse_bound_clumps() const;
  LawKind choose_law() const;
  ContactSource source() const;

  // the step (engine.cpp), in call order
  void begin_step(const engine::StepContext& context);
  void refresh_contacts();
  double search_limit() const;
  void find_levers();
  std::vector<Pair> near_pairs() const;
  void external_forces(const engine::StepContext& context);
  void surface_forces();
  void contact_forces(std::size_t first, std::size_t last);
  std::size_t interface_limit() const;
  void book_step_change(double dt);
  void drift(const engine::StepContext& context);
  void finish_last_step();

  // looking at the state (measure.cpp)
  void measure_potentials();
  void close_ledger();
  double elastic_energy() const;
  double mean_contact_force() const;
  void check_motion() const;
  void count_lost();
  std::vector<double> contact_rows() const;
  std::vector<double> yield_rows() const;

  Grains grains_;
  ContactOptions contact_options_;
  std::vector<Pair> bonds_;
  double skin_ = 0.0;  ///< m
  bool built_ = false;
  Domain built_domain_;            ///< of the contacts
  engine::Options built_options_;  ///< for which the contacts were built
  engine::WeightField built_weights_;

  Rotation rotation_;
  ContactForces contact_;
  LinearNetwork frozen_;
  Walls walls_;
  Block block_;
  Clumps clumps_;
  Sponge sponge_;

  VecField displacement_at_build_;
  double strain_at_build_ = 0.0;  ///< sum of the largest strains since the last search
  std::uint64_t held_groups_ = 0;  ///< constraint groups for which rotations were held
  double step_size_ = 0.0;         ///< for which the mobilities were made, s
  double past_step_ = 0.0;         ///< dt of the drift that led to the present state; 0: none
  std::uint64_t steps_ = 0, rebuilds_ = 0, fast_ = 0;
  std::vector<std::int32_t> lost_;        ///< grains that left the domain, ascending
  double elastic_ = 0.0, gravity_ = 0.0;  ///< at t_n of the last measured step, J
  double step_change_ = 0.0;              ///< lost where the step changed, J; see book_step_change
  engine::Ledger ledger_;
};

}  // namespace gabion::dem
