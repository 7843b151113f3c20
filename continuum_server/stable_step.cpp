#include "continuum_server/stable_step.hpp"

#include <Eigen/Dense>
#include <cmath>
#include <cstdint>

namespace gabion::continuum {

namespace {

using engine::splat;
using engine::Vec;
using engine::VecField;

constexpr int least_iterations = 60;
constexpr int most_iterations = 400;
constexpr int check_every = 5;
constexpr double residual_tolerance = 1e-3;  // of omega^2: half as much of the step
constexpr double nothing_left = 1e-14;       // the vectors span all that the start contains
constexpr double round_off = 1e-12;

double dot(const VecField& a, const VecField& b) {
  double total = 0.0;
  for (std::size_t i = 0; i < a.size(); ++i) total += engine::dot(a[i], b[i]);
  return total;
}

/// Knuth's 64-bit congruential generator; any start with a bit of every mode will do, but always the same.
VecField noise(const VecField& freedom) {
  VecField start(freedom.size());
  std::uint64_t state = 1;
  for (std::size_t i = 0; i < start.size(); ++i)
    for (int axis = 0; axis < 3; ++axis) {
      state = state * 6364136223846793005ull + 1442695040888963407ull;
      start[i][axis] = freedom[i][axis] * (static_cast<double>(state >> 11) * 0x1p-52 - 1.0);
    }
  return start;
}

struct Ritz {
  double value, residual;
};

Ritz largest_ritz(const std::vector<double>& alpha, const std::vector<double>& beta) {
  const auto k = static_cast<Eigen::Index>(alpha.size());
  Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver;
  solver.computeFromTridiagonal(Eigen::Map<const Eigen::VectorXd>(alpha.data(), k),
                                Eigen::Map<const Eigen::VectorXd>(beta.data(), k - 1));
  return {solver.eigenvalues()[k - 1], beta.back() * std::fabs(solver.eigenvectors()(k - 1, k - 1))};
}

}  // namespace

double largest_squared_frequency(const engine::Motion& motion, const StiffnessProduct& product) {
  const std::size_t n = motion.size();
  VecField scale(n), vector = noise(motion.freedom), previous(n), trial(n), next(n);
  for (std::size_t i = 0; i < n; ++i) scale[i] = motion.freedom[i] / splat(std::sqrt(motion.mass[i]));
  double length = std::sqrt(dot(vector, vector));
  if (length == 0.0) return 0.0;

  std::vector<double> alpha, beta;
  double highest = 0.0, bound = 0.0;
  for (int k = 1; k <= most_iterations; ++k) {
    for (std::size_t i = 0; i < n; ++i) {
      vector[i] *= splat(1.0 / length);
      trial[i] = scale[i] * vector[i];
    }
    product(trial, next);
    const Vec back = splat(beta.empty() ? 0.0 : beta.back());
    for (std::size_t i = 0; i < n; ++i) next[i] = -scale[i] * next[i] - back * previous[i];
    alpha.push_back(dot(vector, next));
    for (std::size_t i = 0; i < n; ++i) next[i] -= splat(alpha.back()) * vector[i];
    length = std::sqrt(dot(next, next));
    beta.push_back(length);
    std::swap(previous, vector);
    std::swap(vector, next);

    const bool exhausted = length <= nothing_left * std::fabs(alpha.back());
    if (!exhausted && k % check_every != 0) continue;
    const Ritz ritz = largest_ritz(alpha, beta);
    if (!(ritz.value >= (1 - round_off) * highest))
      break;  // Ritz values only grow: the small problem has defeated its solver
    highest = ritz.value;
    bound = ritz.value + ritz.residual;
    if (exhausted || (k >= least_iterations && ritz.residual <= residual_tolerance * ritz.value)) break;
  }
  return bound;
}

}  // namespace gabion::continuum
