#pragma once
// A scene as the rest of the coupler sees it: SI units, defaults filled in, every name resolved.
// Read by read_scene (read_scene.hpp); meaning of the keys in docs/scenes.md.

#include <array>
#include <cstdint>
#include <limits>
#include <optional>
#include <string>
#include <vector>

namespace gabion::scene {

using Point = std::array<double, 3>;
constexpr double infinity = std::numeric_limits<double>::infinity();

struct Box {
  Point lo{}, hi{};
};

enum class Model { dem, continuum, bridging, edge };

/// A function of time; kinds and parameters as in protocol/engine/history.hpp.
struct History {
  std::string kind = "zero";
  std::vector<double> parameters;
};

/// The same function, later by the given time in s.
History shifted(const History& history, double by);

struct Material {
  std::string name;
  // grains; stiffness of a grain is the coefficient times its radius, two grains in series
  double normal_stiffness = 0.0;      ///< N/m2, k_n over radius
  double shear_stiffness = 0.0;       ///< N/m2, k_s over radius
  double density = 2650.0;            ///< of a grain, kg/m3
  double friction = infinity;         ///< Coulomb coefficient
  double normal_strength = infinity;  ///< N/m2, over min(r1,r2)^2
  double shear_strength = infinity;   ///< N/m2
  double rolling_stiffness = 0.0;     ///< k_r over k_s r1 r2
  double rolling_friction = 0.0;      ///< largest rolling moment over min(r1,r2) times the normal force
  double restitution = 1.0;
  bool rotates = true;
  int clump_size = 1;                 ///< grains joined to one rigid clump; 1: single spheres
  // continuum; absent: measured on the packing
  std::optional<double> young;         ///< Pa
  std::optional<double> poisson;       ///< -
  std::optional<double> bulk_density;  ///< kg/m3
};

struct Fill {
  Box box;
  std::string material;
};

struct Ground {
  Box box;
  std::string material;
  std::array<bool, 3> periodic{};
};

struct Grains {
  std::optional<Box> zone;              ///< absent: the whole ground
  bool zone_to_choose = false;          ///< zone = auto: someone has to put a box in its place before the run
  std::string packing = "random";       ///< random, fcc, sc, file
  std::string file;                     ///< of the packing; empty: none
  double bond_gap = 0.0;                ///< packing from a file: largest gap of a bond over the sum of the radii
  std::string radius_kind = "uniform";  ///< uniform, sieve
  /// m; uniform: smallest and largest; lattice: one value; sieve: radius, share, radius, share ... (share of
  /// the mass passing, 0 to 1)
  std::vector<double> radius;
  double solid_fraction = 0.63;
  double contacts_per_grain = 5.7;
  std::uint32_t min_contacts = 3;
  std::uint64_t seed = 1;
  bool rotations = true;
  std::string geometry = "updated";  ///< frozen, updated
};

/// Elements far from the interface are evaluated less often.
struct Rates {
  int largest = 0;       ///< a power of two; 0: chosen from the stable steps
  bool nested = true;    ///< 2, 4, ... up to the largest, else the largest at once
  int layers = 6;        ///< of elements at each rate on the way to the largest
  int first_layers = 2;  ///< of elements at rate 1 beyond the interface
  double energy_tolerance = 0.1;  ///< of a run with several rates, in place of a smaller Run::energy_tolerance
};

struct Mesh {
  double size = 0.0;     ///< m; the size is fitted to the ground and the zone
  double grading = 1.0;  ///< growth of element size per layer away from the zone
  std::string element = "brick";
  /// Continuum constants from: measured (on the packing), material (young, poisson, bulk_density)
  std::string stiffness = "measured";  ///< measured, measured_isotropic, material
  std::string held_faces = "measured";  ///< measured: as long as the grains held there; plain: on the face
  std::optional<Rates> rates;           ///< absent: all elements take every step
};

struct Sponge {
  double strength = 0.0;  ///< eta L / c; 0: none
};

struct Coupling {
  double overlap = 0.0;         ///< m, bridging
  std::string rows = "mortar";  ///< mortar, mortar2h, strict, edge, edge_projected, edge_hats
  std::string solve = "exact";  ///< exact, row_sum
  Sponge sponge;
  double weight_floor = 0.01;
  double reach = 0.9;            ///< edge: grains within reach * radius of the border plane are tied
  bool border_weights = false;   ///< edge: contacts across the border count with their share on the grains' side
  double rotation_limit = 0.03;  ///< rad, largest rotation of the interface before the run stops
};

/// What holds or drives one face of the ground, in both media.
struct Face {
  std::string kind = "free";  ///< free, fixed, roller, seat, absorbing, wall, pressure, traction, velocity
  History history;            ///< pressure Pa (compression positive), traction Pa, velocity m/s
  Point direction{};          ///< traction and velocity: unit vector; velocity: only its nonzero components are held
  double friction = 0.0;      ///< wall: Coulomb coefficient
};
/// Order: xmin, xmax, ymin, ymax, zmin, zmax.
using Faces = std::array<Face, 6>;

struct Block {
  std::string shape = "cube";  ///< cube, sphere
  double side = 0.0;         ///< m, edge or diameter
  double mass = 0.0;         ///< kg
  std::string tip = "down";  ///< down (corner), edge, face
  Point position{};          ///< centre in x, y; z is set so that the block touches the ground
  Point velocity{};          ///< m/s
  Point spin{};              ///< rad/s
  bool rotation = true;      ///< free
  double friction = 1.0;
  bool touching = true;  ///< false: position[2] is the height of the centre
  int stage = 0;         ///< index of the stage at whose beginning the block is released
};

struct Stage {
  std::string name;
  double damping = 0.0;
  double duration = infinity;            ///< s
  std::uint64_t steps = 0;               ///< 0: not limited by a number of steps
  double unbalanced = 0.0;               ///< ends when the unbalanced measure falls below; 0: not used
  double at_least = 0.0;                 ///< s from the stage's start; unbalanced is not looked at before
  std::uint64_t max_steps = 10'000'000;  ///< gives up beyond, with an error
  /// Faces (0 to 5) that change when the stage begins; times of their histories count from its start, those of
  /// Scene::faces from the start of the run. See shifted().
  std::vector<std::pair<int, Face>> faces;
  bool gravity = true;
  bool zero_displacements = false;  ///< displacements are counted from the start of this stage
};

/// A wave packet put into the ground at the start: u = a cos(k s) exp(-s^2/(2 width^2)), s along axis.
struct Wave {
  int axis = 2;
  int polarisation = 2;     ///< displacement along this axis (2 with axis 2: a P wave)
  double wavelength = 0.0;  ///< m
  double centre = 0.0;      ///< m
  double width = 0.0;       ///< m
  double amplitude = 0.0;   ///< m
  double sense = -1.0;      ///< travels towards +1 or -1
  double speed = 0.0;       ///< m/s; 0: from the measured stiffness
};

/// Motion given to the whole ground at the start, beside a wave.
struct InitialMotion {
  std::array<double, 6> strain{};  ///< xx yy zz yz zx xy, engineering shear; displacement symmetric about the ground's centre
  Point rotation{};                ///< rad, infinitesimal, about the ground's centre
  Point translation{};             ///< m
  Point velocity{};                ///< m/s, the same everywhere
  double noise = 0.0;              ///< m/s, each component uniform in [-noise, noise]
  std::uint64_t noise_seed = 1;
  std::string state;  ///< results.h5 whose last state the grains begin with; empty: none

  bool any() const;
};

struct Probe {
  std::string name;
  Point at{};
};

struct Output {
  double every = 0.0;                 ///< s; 0: only first and last state
  double probe_every = 0.0;           ///< s; 0: every step
  std::uint64_t monitor_steps = 200;  ///< steps between progress, ledger and history rows
  std::vector<std::string> fields;    ///< extra fields beside displacement and velocity
};

struct Run {
  double step_fraction = 0.9;  ///< of the smaller stable step
  std::optional<double> step;  ///< s, fixed step
  int threads_dem = 1;
  int threads_continuum = 1;
  double checkpoint_every = 0.0;   ///< s of wall time; 0: none
  double energy_tolerance = 0.01;  ///< balance over the run, share of the largest energy
  bool measure_energy = true;
};

/// Triaxial tests of the ground as a periodic sample.
struct Laboratory {
  std::vector<double> confinements;  ///< Pa
  double axial_strain = 0.1;
  double peak_strain = 0.002;  ///< slow and finely recorded up to here
  double peak_inertial_number = 1e-4;
  double inertial_number = 5e-4;
  double damping = 0.2;      ///< local, while shearing
  double unbalanced = 1e-3;  ///< at rest when confined
  std::uint64_t max_steps = 200'000;
};

struct Scene {
  std::string title;
  std::string name;  ///< file name without folder and ending
  Model model = Model::bridging;
  Point gravity{};
  Point origin{};  ///< m; every coordinate here and on the wire counts from it, those of the results do not
  Ground ground;
  std::vector<Fill> fills;
  std::vector<Material> materials;  ///< those that ground and fills use
  Grains grains;
  Mesh mesh;
  Coupling coupling;
  Faces faces;
  std::optional<Block> block;
  std::optional<Wave> wave;
  InitialMotion initial;
  std::vector<Stage> stages;
  std::vector<Probe> probes;
  Output output;
  Run run;
  std::optional<Laboratory> laboratory;

  /// Throws std::out_of_range; cannot happen for names that ground and fills use.
  const Material& material(const std::string& wanted) const;
};

/// "dem", "continuum", "bridging", "edge"
std::string to_string(Model model);

/// Whether the packing is one of the lattices.
bool is_lattice(const Grains& grains);

/// Mean diameter of the grains by number, m.
double mean_diameter(const Grains& grains);

}  // namespace gabion::scene
