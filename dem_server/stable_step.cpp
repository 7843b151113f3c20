// Lanczos iteration for the largest eigenvalue (Parlett, The Symmetric Eigenvalue Problem, ch. 13):
//
//   beta_(k+1) q_(k+1) = A q_k - alpha_k q_k - beta_k q_(k-1),    A = M^-1/2 K M^-1/2
//
// An eigenvalue of A lies within |beta_(k+1) y_k| of the largest Ritz value, y its last component in
// the eigenvector of the tridiagonal matrix; the bound is added, so that the step errs on the safe side.

#include "dem_server/stable_step.hpp"

#include <Eigen/Eigenvalues>
#include <cmath>

namespace gabion::dem {
namespace {

/// Displacements and rotations scaled by the roots of masses and inertias.
struct ScaledVector {
  VecField move, turn;

  explicit ScaledVector(std::size_t n = 0) : move(n, Vec{}), turn(n, Vec{}) {}
};

double inner(const ScaledVector& a, const ScaledVector& b) {
  Vec total{};
  for (std::size_t i = 0; i < a.move.size(); ++i) total += a.move[i] * b.move[i] + a.turn[i] * b.turn[i];
  return sum(total);
}

/// a += factor b
void add(ScaledVector& a, double factor, const ScaledVector& b) {
  const Vec f = splat(factor);
  for (std::size_t i = 0; i < a.move.size(); ++i) {
    a.move[i] += f * b.move[i];
    a.turn[i] += f * b.turn[i];
  }
}

void scale(ScaledVector& a, double factor) {
  const Vec f = splat(factor);
  for (std::size_t i = 0; i < a.move.size(); ++i) {
    a.move[i] *= f;
    a.turn[i] *= f;
  }
}

/// Numbers in -1 to 1 that are the same in every run (Marsaglia's xorshift).
class Sequence {
 public:
  double next() {
    state_ ^= state_ << 13;
    state_ ^= state_ >> 7;
    state_ ^= state_ << 17;
    return static_cast<double>(state_ >> 11) * 0x1p-52 - 1.0;
  }

 private:
  std::uint64_t state_ = 0x9e3779b97f4a7c15ull;
};

class Operator {
 public:
  Operator(LinearNetwork& network, const engine::Motion& motion, const Rotation& rotation, bool rotating,
           const Clumps* clumps)
      : network_(network),
        rotating_(rotating),
        clumps_(clumps),
        root_(motion.size()),
        u_(motion.size()),
        f_(motion.size()) {
    for (std::size_t i = 0; i < motion.size(); ++i) {
      const Vec freedom = motion.freedom[i];
      const double root = 1.0 / std::sqrt(motion.mass[i]);
      for (int axis = 0; axis < 3; ++axis) root_.move[i][axis] = freedom[axis] > 0.0 ? root : 0.0;
      if (rotating) root_.turn[i] = vec(1, 1, 1) * splat(std::sqrt(rotation.mobility[i]));
    }
    if (clumps_ != nullptr) join_members(rotation, rotating);
  }

  /// out = A in
  void apply(const ScaledVector& in, ScaledVector& out) {
    for (std::size_t i = 0; i < in.move.size(); ++i) {
      u_.move[i] = root_.move[i] * in.move[i];
      u_.turn[i] = root_.turn[i] * in.turn[i];
      f_.move[i] = f_.turn[i] = Vec{};
    }
    spread_over_members(in);
    network_.add_forces(0, in.move.size(), u_.move, u_.turn, f_.move, f_.turn, rotating_, 1);
    for (std::size_t i = 0; i < in.move.size(); ++i) {
      out.move[i] = -root_.move[i] * f_.move[i];
      out.turn[i] = -root_.turn[i] * f_.turn[i];
    }
    sum_over_members(out);
  }

  ScaledVector start() const {
    ScaledVector q(root_.move.size());
    Sequence random;
    for (std::size_t i = 0; i < q.move.size(); ++i)
      for (int axis = 0; axis < 3; ++axis) {
        q.move[i][axis] = root_.move[i][axis] > 0.0 ? random.next() : 0.0;
        q.turn[i][axis] = root_.turn[i][axis] > 0.0 ? random.next() : 0.0;
      }
    return q;
  }

 private:
  /// A body's six unknowns stand at its first member, the other members have none.
  void join_members(const Rotation& rotation, bool rotating) {
    for (std::size_t b = 0; b < clumps_->size(); ++b) {
      bool turns = rotating;
      for (const std::int32_t i : clumps_->members(b)) {
        turns = turns && rotation.mobility[i] > 0.0;
        root_.move[i] = root_.turn[i] = Vec{};
      }
      const std::int32_t first = clumps_->members(b).front();
      root_.move[first] = vec(1, 1, 1) * splat(1.0 / std::sqrt(clumps_->mass(b)));
      if (turns) root_.turn[first] = vec(1, 1, 1);
      Eigen::Matrix3d inverse;
      const std::array<Vec, 3> columns = clumps_->inverse_inertia(b);
      for (int r = 0; r < 3; ++r)
        for (int c = 0; c < 3; ++c) inverse(r, c) = 0.5 * (columns[c][r] + columns[r][c]);
      const Eigen::Matrix3d root = Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(inverse).operatorSqrt();
      turn_roots_.push_back({});
      for (int c = 0; c < 3 && turns; ++c) turn_roots_.back()[c] = vec(root(0, c), root(1, c), root(2, c));
    }
  }

  Vec turn_root(std::size_t b, Vec x) const {
    const std::array<Vec, 3>& columns = turn_roots_[b];
    return splat(x[0]) * columns[0] + splat(x[1]) * columns[1] + splat(x[2]) * columns[2];
  }

  void spread_over_members(const ScaledVector& in) {
    for (std::size_t b = 0; b < turn_roots_.size(); ++b) {
      const auto members = clumps_->members(b);
      const Vec move = u_.move[members.front()], turn = turn_root(b, in.turn[members.front()]);
      for (std::size_t k = 0; k < members.size(); ++k) {
        u_.move[members[k]] = move + cross(turn, clumps_->arm(b, k));
        u_.turn[members[k]] = turn;
      }
    }
  }

  void sum_over_members(ScaledVector& out) {
    for (std::size_t b = 0; b < turn_roots_.size(); ++b) {
      const auto members = clumps_->members(b);
      Vec force{}, torque{};
      for (std::size_t k = 0; k < members.size(); ++k) {
        const Vec f = f_.move[members[k]];
        force += f;
        torque += f_.turn[members[k]] + cross(clumps_->arm(b, k), f);
      }
      out.move[members.front()] = -root_.move[members.front()] * force;
      out.turn[members.front()] = -turn_root(b, torque);
    }
  }

  LinearNetwork& network_;
  bool rotating_;
  const Clumps* clumps_;
  std::vector<std::array<Vec, 3>> turn_roots_;  ///< J^-1/2 of each clump, by columns; 0 where it does not turn
  ScaledVector root_, u_, f_;
};

}  // namespace

Spectrum highest_eigenvalue(LinearNetwork& network, const engine::Motion& motion, const Rotation& rotation,
                            bool rotating, const Clumps* clumps) {
  constexpr int fewest = 40, most = 400, stride = 10;
  constexpr double wanted = 1e-4;  // residual over eigenvalue
  Operator a(network, motion, rotation, rotating, clumps);
  ScaledVector q = a.start(), before(motion.size()), next(motion.size());
  const double length = std::sqrt(inner(q, q));
  if (!(length > 0.0)) return {};
  scale(q, 1.0 / length);
  std::vector<double> alpha, beta;
  Spectrum spectrum;
  for (int k = 1; k <= most; ++k) {
    a.apply(q, next);
    if (k > 1) add(next, -beta.back(), before);
    alpha.push_back(inner(q, next));
    add(next, -alpha.back(), q);
    const double remainder = std::sqrt(inner(next, next));
    const bool exhausted = remainder <= 1e-14 * std::fabs(alpha.front());
    if (exhausted || k == most || (k >= fewest && k % stride == 0)) {
      Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> ritz;
      const Eigen::Map<const Eigen::VectorXd> main(alpha.data(), k), side(beta.data(), k - 1);
      ritz.computeFromTridiagonal(main, side, Eigen::ComputeEigenvectors);
      const double top = ritz.eigenvalues()(k - 1);
      const double bound = remainder * std::fabs(ritz.eigenvectors()(k - 1, k - 1));
      spectrum = {top + bound, top > 0.0 ? bound / top : 0.0, k};
      if (exhausted || bound <= wanted * top) break;
    }
    beta.push_back(remainder);
    scale(next, 1.0 / remainder);
    std::swap(before, q);
    std::swap(q, next);
  }
  return spectrum;
}

}  // namespace gabion::dem
