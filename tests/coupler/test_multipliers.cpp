#include <Eigen/Dense>
#include <catch2/catch.hpp>
#include <cmath>

#include "tests/coupler/sample.hpp"

using namespace sample;

namespace {

/// Rows applied to a velocity component of points.
Eigen::VectorXd apply(const coupler::SparseRows& rows, const Eigen::VectorXd& v) {
  Eigen::VectorXd out = Eigen::VectorXd::Zero(static_cast<long>(rows.rows()));
  for (std::size_t r = 0; r < rows.rows(); ++r)
    for (std::int32_t k = rows.row_ptr[r]; k < rows.row_ptr[r + 1]; ++k) out[static_cast<long>(r)] += rows.values[k] * v[rows.columns[k]];
  return out;
}

Eigen::VectorXd turned(const coupler::SparseRows& rows, const Eigen::VectorXd& mu, long points) {
  Eigen::VectorXd out = Eigen::VectorXd::Zero(points);
  for (std::size_t r = 0; r < rows.rows(); ++r)
    for (std::int32_t k = rows.row_ptr[r]; k < rows.row_ptr[r + 1]; ++k) out[rows.columns[k]] += rows.values[k] * mu[static_cast<long>(r)];
  return out;
}

std::vector<double> triples(const Eigen::VectorXd& a) {
  std::vector<double> out;
  for (long i = 0; i < a.size(); ++i) out.insert(out.end(), {a[i], -a[i], 2 * a[i]});
  return out;
}

}  // namespace

TEST_CASE("the multipliers close every gap and change no momentum", "[multipliers]") {
  const bool edge = GENERATE(false, true);
  const Ground g = Ground::make(half, 3.0, 1.5, edge);
  const auto rows = g.rows(edge ? "edge_hats" : "mortar", 1.25);
  const coupler::Inertia grains = g.grain_inertia(), nodes = g.node_inertia();
  coupler::Multipliers multipliers(rows, grains, nodes, false);
  CHECK(multipliers.report().rank == rows.slots);

  Eigen::VectorXd v = Eigen::VectorXd::Random(static_cast<long>(g.grains.position.size()));
  Eigen::VectorXd big_v = Eigen::VectorXd::Random(static_cast<long>(g.mesh.nodes.size()));
  std::vector<double> answer(3 * rows.slots);
  multipliers.solve(triples(apply(rows.grains, v)), triples(apply(rows.nodes, big_v)), answer);
  Eigen::VectorXd mu(static_cast<long>(rows.slots));
  for (std::size_t r = 0; r < rows.slots; ++r) {
    mu[static_cast<long>(r)] = answer[3 * r];
    REQUIRE(answer[3 * r + 1] == Approx(-answer[3 * r]).margin(1e-12));
  }
  const Eigen::VectorXd on_grains = -turned(rows.grains, mu, v.size()), on_nodes = -turned(rows.nodes, mu, big_v.size());
  for (long i = 0; i < v.size(); ++i) v[i] += on_grains[i] / g.grains.plain_mass[static_cast<std::size_t>(i)];
  big_v += on_nodes / 3.0;
  CHECK((apply(rows.grains, v) + apply(rows.nodes, big_v)).cwiseAbs().maxCoeff() < 1e-11);
  CHECK(std::fabs(on_grains.sum() + on_nodes.sum()) < 1e-11 * on_grains.cwiseAbs().sum());
}

TEST_CASE("slaved grains and nodes keep their momentum", "[multipliers]") {
  const bool edge = GENERATE(false, true);
  const Ground g = Ground::make(half, 3.0, 1.5, edge);
  const auto rows = g.rows(edge ? "edge" : "strict");
  coupler::Multipliers multipliers(rows, g.grain_inertia(), g.node_inertia(), false);
  // trial displacements u*, U*: the engines send N^T m u* and M U*
  const Eigen::VectorXd u = Eigen::VectorXd::Random(static_cast<long>(rows.tied_grains.size()));
  const Eigen::VectorXd big_u = Eigen::VectorXd::Random(static_cast<long>(rows.slots));
  Eigen::VectorXd weighted = u;
  double before = 0.0;
  for (long t = 0; t < u.size(); ++t) before += weighted[t] *= g.grains.plain_mass[rows.tied_grains[t]];
  before += 3.0 * big_u.sum();
  std::vector<double> answer(3 * rows.slots);
  multipliers.solve(triples(turned(rows.grains, weighted, static_cast<long>(rows.slots))), triples(3.0 * big_u), answer);
  Eigen::VectorXd solved(static_cast<long>(rows.slots));
  for (std::size_t s = 0; s < rows.slots; ++s) solved[static_cast<long>(s)] = answer[3 * s];
  const Eigen::VectorXd followed = apply(rows.grains, solved);
  double after = 3.0 * solved.sum();
  for (long t = 0; t < u.size(); ++t) after += followed[t] * g.grains.plain_mass[rows.tied_grains[t]];
  CHECK(after == Approx(before).epsilon(1e-12));
}

TEST_CASE("a prescribed node keeps its trial motion under slave rows", "[multipliers]") {
  const Ground g = Ground::make(half, 0.0, 1.5, true);
  const auto rows = g.rows("edge");
  coupler::Inertia nodes = g.node_inertia();
  nodes.freedom[rows.tied_nodes[3]] = {0, 1, 1};
  coupler::Multipliers multipliers(rows, g.grain_inertia(), nodes, false);
  std::vector<double> from_grains(3 * rows.slots, 0.25), from_nodes(3 * rows.slots, 0.6), answer(3 * rows.slots);
  multipliers.solve(from_grains, from_nodes, answer);
  CHECK(answer[9] == Approx(0.6 / 3.0).epsilon(1e-12));
  CHECK(answer[10] != Approx(0.6 / 3.0).epsilon(1e-3));
}

TEST_CASE("more multipliers than grains can carry: reduced, with the rank", "[multipliers]") {
  using Matrix = coupler::Factor::Matrix;
  // three rows that say the same thing on two points, and one of its own
  Eigen::MatrixXd g(4, 3);
  g << 1, -1, 0, 2, -2, 0, -1, 1, 0, 0, 1, -1;
  const Matrix a = Matrix((g * g.transpose()).sparseView());
  const coupler::Factor factor(a);
  CHECK(factor.rank() == 2);
  const Eigen::Vector3d v(0.3, -0.4, 0.9);
  const Eigen::VectorXd gap = g * v;
  std::vector<coupler::Triple> b(4);
  for (int i = 0; i < 4; ++i) b[i] = {gap[i], 0.0, 0.0};
  factor.solve(b);
  Eigen::VectorXd mu(4);
  for (int i = 0; i < 4; ++i) mu[i] = b[i][0];
  CHECK((g * (v - g.transpose() * mu)).norm() < 1e-12);
}

TEST_CASE("factor: three right-hand sides against a dense solve", "[multipliers]") {
  const Ground g = Ground::make(pit, 3.0, 1.5, false);
  const auto rows = g.rows("mortar");
  coupler::Multipliers multipliers(rows, g.grain_inertia(), g.node_inertia(), false);
  CHECK(multipliers.report().condition > 1.0);
  CHECK(multipliers.report().condition < 1e4);
}

TEST_CASE("row_sum divides each strict gap by its row", "[multipliers]") {
  const Ground g = Ground::make(half, 3.0, 1.5, false);
  const auto rows = coupler::explicit_rows(g.rows("strict"));
  coupler::Multipliers multipliers(rows, g.grain_inertia(), g.node_inertia(), true);
  // equal gaps everywhere are closed exactly by row sums
  std::vector<double> gap(3 * rows.slots, 1.0), zero(3 * rows.slots, 0.0), answer(3 * rows.slots);
  multipliers.solve(gap, zero, answer);
  for (const double mu : answer) REQUIRE(mu > 0.0);
}
