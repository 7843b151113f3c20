#include "dem_server/packing/equilibrium.hpp"

#include <algorithm>
#include <cmath>

namespace gabion::dem {
namespace {

using Block = Eigen::Matrix<double, 6, 6>;

double product(const GrainMotion& a, const GrainMotion& b) {
  Vec total{};
  for (std::size_t k = 0; k < a.size(); ++k) total += a[k] * b[k];
  return engine::sum(total);
}

Vec affine(const Eigen::Matrix3d& strain, Vec d) {
  Vec result{};
  for (int a = 0; a < 3; ++a) result[a] = strain(a, 0) * d[0] + strain(a, 1) * d[1] + strain(a, 2) * d[2];
  return result;
}

Vec contact_force(Vec normal, double k_n, double k_s, Vec delta) {
  return splat(k_s) * delta + splat((k_n - k_s) * dot(delta, normal)) * normal;
}

/// x with x_cross * v = a n x v
Eigen::Matrix3d cross_matrix(double a, Vec n) {
  Eigen::Matrix3d x;
  x << 0.0, -n[2], n[1], n[2], 0.0, -n[0], -n[1], n[0], 0.0;
  return a * x;
}

}  // namespace

Equilibrium::Equilibrium(const BondNetwork& network, std::vector<std::uint8_t> fixed, VecField beyond)
    : network_(network), fixed_(std::move(fixed)), beyond_(std::move(beyond)), mean_radius_(network.mean_radius()) {
  fixed_.resize(network.size(), 0);
  floating_ = std::none_of(fixed_.begin(), fixed_.end(), [](std::uint8_t f) { return f != 0; });
  springs_.reserve(network.bonds.size());
  for (const Bond& b : network.bonds)
    springs_.push_back({b.normal, b.a_i / mean_radius_, b.a_j / mean_radius_, b.k_n, b.k_s, b.i, b.j});
  factor_blocks();
}

// Block of grain i from one bond, motion (w, theta R): delta = -+w + a X theta with X v = n x v, so with
// K = k_s I + (k_n - k_s) n n^T and B = [-+I, aX]: block = B^T K B; K X = k_s X, as X maps off n.
void Equilibrium::factor_blocks() {
  std::vector<Block> blocks(network_.size(), Block::Zero());
  for (const Spring& s : springs_) {
    const Eigen::Vector3d n(s.normal[0], s.normal[1], s.normal[2]);
    const Eigen::Matrix3d stiffness = s.k_s * Eigen::Matrix3d::Identity() + (s.k_n - s.k_s) * n * n.transpose();
    const auto add = [&](std::int32_t grain, double side, double a) {
      Eigen::Matrix<double, 3, 6> b;
      b << side * Eigen::Matrix3d::Identity(), cross_matrix(turns(grain) ? a : 0.0, s.normal);
      blocks[grain] += b.transpose() * stiffness * b;
    };
    add(s.i, -1.0, s.a_i);
    add(s.j, 1.0, s.a_j);
  }
  constexpr double zero_over_largest = 1e-10;
  inverse_blocks_.assign(36 * network_.size(), 0.0);
  for (std::size_t g = 0; g < network_.size(); ++g) {
    if (fixed_[g] == all_fixed) continue;
    for (int k = 0; k < 6; ++k)
      if (fixed_[g] & (k < 3 ? 1 << k : rotations_fixed)) blocks[g].row(k).setZero(), blocks[g].col(k).setZero();
    const Eigen::SelfAdjointEigenSolver<Block> modes(blocks[g]);
    const double threshold = zero_over_largest * modes.eigenvalues()[5];
    Block inverse = Block::Zero();
    for (int m = 0; m < 6; ++m)
      if (modes.eigenvalues()[m] > threshold)
        inverse += modes.eigenvectors().col(m) * modes.eigenvectors().col(m).transpose() / modes.eigenvalues()[m];
    Eigen::Map<Block>{inverse_blocks_.data() + 36 * g} = inverse;
  }
}

inline Vec Equilibrium::spring_force(const Spring& s, const GrainMotion& motion) const {
  const Vec turn = splat(s.a_i) * motion[2 * s.i + 1] + splat(s.a_j) * motion[2 * s.j + 1];
  return contact_force(s.normal, s.k_n, s.k_s, motion[2 * s.j] - motion[2 * s.i] - cross(turn, s.normal));
}

inline void Equilibrium::apply(const Spring& s, Vec force, GrainMotion& out) const {
  const Vec torque = cross(s.normal, force);
  out[2 * s.i] += force;
  out[2 * s.j] -= force;
  out[2 * s.i + 1] += splat(s.a_i) * torque;
  out[2 * s.j + 1] += splat(s.a_j) * torque;
}

void Equilibrium::settle(GrainMotion& field) const {
  if (floating_) {
    Vec mean{};
    for (std::size_t g = 0; g < fixed_.size(); ++g) mean += field[2 * g];
    mean /= splat(static_cast<double>(fixed_.size()));
    for (std::size_t g = 0; g < fixed_.size(); ++g) field[2 * g] -= mean;
  }
  for (std::size_t g = 0; g < fixed_.size(); ++g) {
    field[2 * g] *= free_components(g);
    if ((fixed_[g] & rotations_fixed) || !turns(g)) field[2 * g + 1] = Vec{};
  }
}

/// 1 in the components that move freely.
Vec Equilibrium::free_components(std::size_t grain) const {
  const std::uint8_t bits = fixed_[grain];
  return engine::vec(bits & 1 ? 0.0 : 1.0, bits & 2 ? 0.0 : 1.0, bits & 4 ? 0.0 : 1.0);
}

void Equilibrium::resist(const GrainMotion& motion, GrainMotion& out) const {
  std::fill(out.begin(), out.end(), Vec{});
  for (const Spring& s : springs_) apply(s, -spring_force(s, motion), out);
  settle(out);
}

void Equilibrium::load(const Eigen::Matrix3d& strain, GrainMotion& out) const {
  std::fill(out.begin(), out.end(), Vec{});
  for (std::size_t b = 0; b < springs_.size(); ++b) {
    const Spring& s = springs_[b];
    apply(s, contact_force(s.normal, s.k_n, s.k_s, affine(strain, network_.bonds[b].branch())), out);
  }
  settle(out);
}

void Equilibrium::precondition(const GrainMotion& residual, GrainMotion& out) const {
  for (std::size_t g = 0; g < fixed_.size(); ++g) {
    Eigen::Matrix<double, 6, 1> r;
    r << residual[2 * g][0], residual[2 * g][1], residual[2 * g][2], residual[2 * g + 1][0], residual[2 * g + 1][1],
        residual[2 * g + 1][2];
    const Eigen::Matrix<double, 6, 1> z = Eigen::Map<const Block>(inverse_blocks_.data() + 36 * g) * r;
    out[2 * g] = engine::vec(z[0], z[1], z[2]);
    out[2 * g + 1] = engine::vec(z[3], z[4], z[5]);
  }
  if (floating_) settle(out);
}

SolveOutcome Equilibrium::solve(const Eigen::Matrix3d& strain, const SolveLimits& limits, GrainMotion& motion) const {
  const std::size_t length = 2 * network_.size();
  motion.resize(length, Vec{});
  settle(motion);
  GrainMotion residual(length), direction(length), pulled(length), scaled(length);
  load(strain, residual);
  double target = std::sqrt(product(residual, residual));
  if (!beyond_.empty()) {
    GrainMotion prescribed(length), asked = residual;
    for (std::size_t g = 0; g < fixed_.size(); ++g)
      prescribed[2 * g] = (engine::vec(1, 1, 1) - free_components(g)) * beyond_[g];
    resist(prescribed, pulled);
    for (std::size_t k = 0; k < length; ++k) asked[k] -= pulled[k], motion[k] += prescribed[k];
    target = std::sqrt(product(asked, asked));
  }
  SolveOutcome outcome;
  if (target == 0.0) {
    std::fill(motion.begin(), motion.end(), Vec{});
    return outcome;
  }
  resist(motion, pulled);
  for (std::size_t k = 0; k < length; ++k) residual[k] -= pulled[k];
  precondition(residual, scaled);
  direction = scaled;
  double rho = product(residual, scaled);
  for (;;) {
    outcome.residual = std::sqrt(product(residual, residual)) / target;
    outcome.converged = outcome.residual <= limits.residual;
    if (outcome.converged || outcome.iterations >= limits.iterations || rho <= 0.0) return outcome;
    resist(direction, pulled);
    const double curvature = product(direction, pulled);
    if (!(curvature > 0.0)) return outcome;  // a mechanism: nothing resists this direction
    const Vec step = splat(rho / curvature);
    for (std::size_t k = 0; k < length; ++k) {
      motion[k] += step * direction[k];
      residual[k] -= step * pulled[k];
    }
    precondition(residual, scaled);
    const double next = product(residual, scaled);
    const Vec turn = splat(next / rho);
    for (std::size_t k = 0; k < length; ++k) direction[k] = scaled[k] + turn * direction[k];
    rho = next;
    ++outcome.iterations;
  }
}

Vec Equilibrium::bond_force(std::size_t bond, const Eigen::Matrix3d& strain, const GrainMotion& motion) const {
  const Spring& s = springs_[bond];
  return spring_force(s, motion) + contact_force(s.normal, s.k_n, s.k_s, affine(strain, network_.bonds[bond].branch()));
}

}  // namespace gabion::dem
