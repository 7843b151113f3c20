// The engine's side of a tie: interface grains first, gap, correction, energy.

#include <Eigen/Dense>

#include "fixture.hpp"

using namespace gabion::dem;
using namespace gabion::dem::testing;
using gabion::engine::Tie;

namespace {

/// Plays the coupler with a partner that does not move: A mu = g, A = G m^-1 G^T.
struct StillPartner : gabion::engine::Exchange {
  Eigen::MatrixXd compliance;
  Eigen::MatrixXd answer;
  int steps_left = 1 << 30;

  StillPartner(const Eigen::MatrixXd& rows, const DemEngine& engine) {
    Eigen::MatrixXd scaled = rows;
    for (Eigen::Index i = 0; i < rows.cols(); ++i) scaled.col(i) /= engine.motion.mass[i];
    compliance = (scaled * rows.transpose()).inverse();
  }
  void send_gap(std::span<const double> gap) override {
    const auto rows = static_cast<Eigen::Index>(gap.size() / 3);
    answer = compliance * Eigen::Map<const Eigen::Matrix<double, -1, 3, Eigen::RowMajor>>(gap.data(), rows, 3);
  }
  bool receive_multipliers(std::span<double> values) override {
    Eigen::Map<Eigen::Matrix<double, -1, 3, Eigen::RowMajor>>(values.data(), answer.rows(), 3) = answer;
    return --steps_left > 0;
  }
};

/// The first 16 grains are tied by 3 rows of their masses.
struct Tied : Scene {
  Eigen::MatrixXd rows = Eigen::MatrixXd::Zero(3, 16);

  explicit Tied(Geometry geometry, int threads = 1) {
    const Spheres s = jittered(4);
    engine.threads = threads;
    grains(s.x, s.r, elastic_material());
    engine.make_bonds(0.35);
    prepare(geometry);
    set("velocity", random_field(64, 0.01, 5));
    std::vector<std::int32_t> ptr{0}, columns;
    std::vector<double> values;
    for (int row = 0; row < 3; ++row) {
      for (int i = 0; i < 16; ++i) {
        rows(row, i) = -engine.motion.plain_mass[i] * std::cos(row * i);
        columns.push_back(i);
        values.push_back(rows(row, i));
      }
      ptr.push_back(static_cast<std::int32_t>(columns.size()));
    }
    engine.tie.set(Tie::Mode::gap, 3, {}, ptr, columns, values, engine.motion);
  }
};

}  // namespace

TEST_CASE("tied grains keep their rows, and the work of the multipliers closes the balance") {
  Tied s(Geometry::frozen);
  StillPartner partner(s.rows, s.engine);
  const double dt = 0.9 * s.engine.stable_step();
  const auto run = [&](int count) {
    for (int k = 0; k < count; ++k, s.time += dt) s.engine.step({s.time, dt, 0.0, k + 1 == count}, partner);
  };
  run(1);
  const double before = s.engine.ledger().balance();
  for (int k = 0; k < 10; ++k) {
    run(100);
    CHECK(s.engine.ledger().balance() == Approx(before).epsilon(1e-12));
    Vec slip[3] = {};
    for (int row = 0; row < 3; ++row)
      for (int i = 0; i < 16; ++i) slip[row] += splat(s.rows(row, i)) * s.engine.motion.displacement[i];
    for (const Vec d : slip) CHECK(norm(d) < 1e-12);
  }
  CHECK(s.energy("multipliers") != 0.0);
  CHECK(s.count("tied_contacts") > 16);
  partner.steps_left = 1;
  CHECK_FALSE(s.engine.step({s.time, dt, 0.0, false}, partner));
}

TEST_CASE("doing the interface first changes no bits, with one thread or two") {
  for (const Geometry geometry : {Geometry::frozen, Geometry::updated}) {
    // rows that are given but answered by zeros leave the grains alone
    struct Silent : gabion::engine::Exchange {
      void send_gap(std::span<const double>) override {}
      bool receive_multipliers(std::span<double> values) override {
        std::fill(values.begin(), values.end(), 0.0);
        return true;
      }
    } silent;
    std::uint64_t hashes[3];
    for (const int variant : {0, 1, 2}) {
      Tied s(geometry, variant == 2 ? 2 : 1);
      if (variant == 0) s.engine.tie.clear();
      for (int k = 0; k < 20; ++k) s.engine.step({k * 1e-3, 1e-3, 0.1, false}, silent);
      hashes[variant] = s.engine.state_hash();
    }
    CHECK(hashes[0] == hashes[1]);
    CHECK(hashes[0] == hashes[2]);
  }
}
