#pragma once
// What the tests of the continuum engine share: an engine alone, set up in a line, and a static solver on its
// element stiffness.

#include <Eigen/Sparse>
#include <Eigen/SparseCholesky>
#include <functional>
#include <map>

#include "continuum_server/box_mesh.hpp"
#include "continuum_server/continuum_engine.hpp"

namespace gabion::continuum {

/// For engines without a tie.
struct Alone : engine::Exchange {
  void send_gap(std::span<const double>) override { throw std::logic_error("nobody to send a gap to"); }
  bool receive_multipliers(std::span<double>) override { throw std::logic_error("nobody to hear from"); }
};

/// An engine with its clock.
struct Solid {
  ContinuumEngine engine;
  double time = 0.0;
  Alone nobody;

  Solid(Mesh mesh, const SolidMaterial& material, bool measure = true, Vec period = Vec{}) {
    engine.options.measure_energy = measure;
    engine.options.box_hi = period;
    engine.set_mesh(std::move(mesh));
    engine.set_materials({material});
  }

  void run(int steps, double dt, double damping = 0.0) {
    for (int k = 0; k < steps; ++k, time += dt) engine.step({time, dt, damping, k == steps - 1}, nobody);
  }

  std::vector<std::int32_t> nodes(const std::function<bool(Vec)>& where) const {
    std::vector<std::int32_t> found;
    for (std::size_t n = 0; n < engine.motion.size(); ++n)
      if (where(engine.motion.position[n])) found.push_back(static_cast<std::int32_t>(n));
    return found;
  }

  /// Holds components (bits) of some nodes.
  void hold(const std::string& name, const std::function<bool(Vec)>& where, std::uint8_t components) {
    engine.boundary.add(engine::Constraint{name, nodes(where), components, Vec{}, {}}, engine.motion.size());
  }

  std::vector<double> values(const std::string& field) const {
    std::vector<std::uint64_t> shape;
    return engine.field(field, shape).value();
  }

  /// Displacement and velocity from a function of the position.
  void set(VecField& field, const std::function<Vec(Vec)>& value) {
    for (std::size_t n = 0; n < field.size(); ++n) field[n] = value(engine.motion.position[n]);
  }

  /// Reproducible numbers in [-1, 1] a component.
  void set_noise(VecField& field, double amplitude) {
    std::uint32_t state = 7;
    for (Vec& v : field)
      for (int axis = 0; axis < 3; ++axis) {
        state = state * 1664525u + 1013904223u;
        v[axis] = amplitude * (2.0 * (state >> 8) / double(1 << 24) - 1.0);
      }
  }

  /// Solves K u = f with some degrees of freedom (3 node + axis) given, into motion.displacement.
  void solve_static(const std::map<int, double>& given, const VecField& load) {
    const auto count = static_cast<int>(3 * engine.motion.size());
    std::vector<int> unknown(count, -1);
    int unknowns = 0;
    for (int d = 0; d < count; ++d)
      if (!given.contains(d)) unknown[d] = unknowns++;
    Eigen::VectorXd right = Eigen::VectorXd::Zero(unknowns);
    for (int d = 0; d < count; ++d)
      if (unknown[d] >= 0) right[unknown[d]] = load[d / 3][d % 3];
    std::vector<Eigen::Triplet<double>> entries;
    for (std::size_t e = 0; e < engine.mesh().elements.size(); ++e) {
      const ElementStiffness k = engine.element_stiffness(e);
      const auto& nodes = engine.mesh().elements[e];
      for (int r = 0; r < 24; ++r)
        for (int s = 0; s < 24; ++s) {
          const int row = 3 * nodes[r / 3] + r % 3, column = 3 * nodes[s / 3] + s % 3;
          if (unknown[row] < 0) continue;
          if (unknown[column] >= 0)
            entries.emplace_back(unknown[row], unknown[column], k[24 * r + s]);
          else
            right[unknown[row]] -= k[24 * r + s] * given.at(column);
        }
    }
    Eigen::SparseMatrix<double> matrix(unknowns, unknowns);
    matrix.setFromTriplets(entries.begin(), entries.end());
    const Eigen::VectorXd solution = Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>>(matrix).solve(right);
    for (int d = 0; d < count; ++d)
      engine.motion.displacement[d / 3][d % 3] = unknown[d] >= 0 ? solution[unknown[d]] : given.at(d);
  }
};

/// A symmetric positive definite stiffness without any symmetry of the material, of order 1 Pa.
inline SolidMaterial triclinic() {
  SolidMaterial material = isotropic(1.0, 0.3, 1.0);
  std::uint32_t state = 99;
  for (int r = 0; r < 6; ++r)
    for (int s = r; s < 6; ++s) {
      state = state * 1664525u + 1013904223u;
      const double extra = 0.05 * (2.0 * (state >> 8) / double(1 << 24) - 1.0);
      material.stiffness[6 * r + s] += extra;
      if (s > r) material.stiffness[6 * s + r] += extra;
    }
  return material;
}

}  // namespace gabion::continuum
