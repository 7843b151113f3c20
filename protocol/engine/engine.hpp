#pragma once
// What the session can ask of an engine. dem_server and continuum_server each implement it; neither
// knows of sockets, scenes or files.

#include <atomic>
#include <cstdint>
#include <optional>
#include <span>
#include <stdexcept>
#include <string>
#include <vector>

#include "protocol/engine/boundary.hpp"
#include "protocol/engine/ledger.hpp"
#include "protocol/engine/motion.hpp"
#include "protocol/engine/probes.hpp"
#include "protocol/engine/tie.hpp"

namespace gabion::engine {

/// Trouble in the physics: a value that cannot go on (NaN, inverted element, lost grain), with the entity.
/// Becomes an ERROR message with code "physics".
struct PhysicsError : std::runtime_error {
  PhysicsError(std::string where_, const std::string& message, std::string advice_)
      : std::runtime_error(message), where(std::move(where_)), advice(std::move(advice_)) {}
  std::string where, advice;
};

/// A request that makes no sense: becomes an ERROR message with code "value".
struct RequestError : std::runtime_error {
  RequestError(std::string where_, const std::string& message, std::string advice_)
      : std::runtime_error(message), where(std::move(where_)), advice(std::move(advice_)) {}
  std::string where, advice;
};

/// Weights of grains where a continuum stands for them too.
/// Bridging, width above 0: w(X) = clamp(min over finite faces of (distance inward from the outer face)/width, floor, 1).
/// Border, width 0 and a finite face: w of a contact is the share of its branch inside the outer box, at least floor.
struct WeightField {
  Vec outer_lo = vec(-INFINITY, -INFINITY, -INFINITY);
  Vec outer_hi = vec(INFINITY, INFINITY, INFINITY);
  double width = 0.0;  ///< m
  double floor = 0.0;

  bool border() const {
    bool finite = false;
    for (int axis = 0; axis < 3; ++axis) finite = finite || std::isfinite(outer_lo[axis]) || std::isfinite(outer_hi[axis]);
    return width <= 0.0 && finite;
  }

  /// Share of the line from x to x + branch inside the outer box, at least floor. A line in a face counts half.
  double share_of_line(Vec x, Vec branch) const {
    const double hair = 1e-6 * (std::fabs(branch[0]) + std::fabs(branch[1]) + std::fabs(branch[2]));
    double from = 0.0, to = 1.0, in_face = 1.0;
    for (int axis = 0; axis < 3; ++axis) {
      const double lo = outer_lo[axis] - x[axis], hi = outer_hi[axis] - x[axis], b = branch[axis];
      if (std::fabs(b) < hair) {
        const double inside = std::fmin(-lo, hi);
        if (inside < -hair) return floor;
        if (inside <= hair) in_face *= 0.5;
        continue;
      }
      from = std::fmax(from, std::fmin(lo / b, hi / b));
      to = std::fmin(to, std::fmax(lo / b, hi / b));
    }
    return std::fmax(floor, in_face * (to - from));
  }

  /// Weight of a grain of radius r [m] at x on its own: w(x), or at a border its share inside the outer box.
  double of_grain(Vec x, double r) const {
    if (!border()) return at(x);
    double nearest = INFINITY;
    for (int axis = 0; axis < 3; ++axis)
      nearest = std::fmin(nearest, std::fmin(x[axis] - outer_lo[axis], outer_hi[axis] - x[axis]));
    return std::fmin(1.0, std::fmax(floor, 0.5 + 0.5 * nearest / r));
  }

  double at(Vec x) const {
    if (width <= 0.0) return 1.0;
    double nearest = INFINITY;
    for (int axis = 0; axis < 3; ++axis)
      nearest = std::fmin(nearest, std::fmin(x[axis] - outer_lo[axis], outer_hi[axis] - x[axis]));
    return std::fmin(1.0, std::fmax(floor, nearest / width));
  }
};

struct Options {
  Vec gravity{};  ///< m/s2
  Vec box_lo{}, box_hi{};
  bool periodic[3] = {false, false, false};
  bool measure_energy = false;
};

struct NamedCount {
  std::string name;
  double value;
};

class Engine {
 public:
  virtual ~Engine() = default;

  Options options;
  WeightField weights;
  Motion motion;
  Boundary boundary;
  Tie tie;
  Probes probes;
  int threads = 1;

  /// For heartbeats, read by another thread.
  std::atomic<const char*> phase{"idle"};
  std::atomic<std::uint64_t> current_step{0};

  /// Builds contacts or stiffness, masses, freedom. May be called again after a change.
  virtual void prepare() = 0;
  /// Largest stable step of this engine alone, without damping, s. Call after prepare.
  virtual double stable_step() = 0;
  /// Steps after which all points stand at one time; runs take whole periods. 1 unless points have several rates.
  virtual std::uint64_t period() const { return 1; }
  /// One step of the algorithm; false when the coupler asked to stop after it.
  virtual bool step(const StepContext& context, Exchange& exchange) = 0;

  /// PhysicsError with the entity where the state cannot go on; asked at the end of each run.
  virtual void check_health() const {}

  /// Linear momentum (3), angular momentum about the origin (3), sum of m |v| (1), weighted masses, kg m/s.
  virtual std::vector<double> momentum() const { return motion.momentum(); }
  /// Energies at the last step that was measured.
  virtual Ledger ledger() const = 0;
  virtual std::vector<NamedCount> counters() const = 0;
  /// Mean unbalanced force (multipliers included) over the mean contact or element nodal force.
  virtual double unbalanced() const = 0;
  /// Entity first; nullopt when there is no such field. shape gets 1 or 2 extents.
  virtual std::optional<std::vector<double>> field(const std::string& name, std::vector<std::uint64_t>& shape) const = 0;
  /// displacement, velocity, and for grains rotation, spin. values: [n][3]. Throws RequestError.
  virtual void set_field(const std::string& name, std::span<const double> values) = 0;
  virtual std::uint64_t state_hash() const = 0;
  /// The whole state, opaque; restore needs an engine that was set up the same way.
  virtual std::vector<std::uint8_t> checkpoint() const = 0;
  virtual void restore(std::span<const std::uint8_t> blob) = 0;
};

}  // namespace gabion::engine
