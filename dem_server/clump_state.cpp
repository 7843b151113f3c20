// Clumps: set-up, and bodies from the fields of their members.

#include <Eigen/Eigenvalues>
#include <cmath>

#include "dem_server/clumps.hpp"

namespace gabion::dem {
namespace {

using Eigen::Matrix3d;

Matrix3d outer(Vec a, Vec b) {
  return Eigen::Vector3d(a[0], a[1], a[2]) * Eigen::RowVector3d(b[0], b[1], b[2]);
}

std::array<Vec, 3> columns_of(const Matrix3d& m) {
  std::array<Vec, 3> columns;
  for (int c = 0; c < 3; ++c) columns[c] = vec(m(0, c), m(1, c), m(2, c));
  return columns;
}

Vec times(const std::array<Vec, 3>& columns, Vec x) {
  return splat(x[0]) * columns[0] + splat(x[1]) * columns[1] + splat(x[2]) * columns[2];
}

/// The rotation that fits best in the sense of least squares, from s = sum of m x_before x_after^T (Horn 1987).
Quaternion best_rotation(const Matrix3d& s) {
  Eigen::Matrix4d n;
  n << s(0, 0) + s(1, 1) + s(2, 2), s(1, 2) - s(2, 1), s(2, 0) - s(0, 2), s(0, 1) - s(1, 0),  //
      s(1, 2) - s(2, 1), s(0, 0) - s(1, 1) - s(2, 2), s(0, 1) + s(1, 0), s(2, 0) + s(0, 2),   //
      s(2, 0) - s(0, 2), s(0, 1) + s(1, 0), -s(0, 0) + s(1, 1) - s(2, 2), s(1, 2) + s(2, 1),  //
      s(0, 1) - s(1, 0), s(2, 0) + s(0, 2), s(1, 2) + s(2, 1), -s(0, 0) - s(1, 1) + s(2, 2);
  const Eigen::Vector4d q = Eigen::SelfAdjointEigenSolver<Eigen::Matrix4d>(n).eigenvectors().col(3);
  const double sign = q(0) < 0.0 ? -1.0 : 1.0;
  return {sign * q(0), sign * q(1), sign * q(2), sign * q(3)};
}

}  // namespace

void Clumps::set(ClumpGrouping grouping, std::size_t grains) {
  clear();
  start_ = std::move(grouping.start);
  grain_ = std::move(grouping.grain);
  image_ = std::move(grouping.image);
  const std::size_t count = start_.size() - 1;
  if (count == 0) return;
  body_of_.assign(grains, -1);
  place_of_.assign(grains, -1);
  for (std::size_t b = 0; b < count; ++b)
    for (std::int32_t k = start_[b]; k < start_[b + 1]; ++k) {
      body_of_[grain_[k]] = static_cast<std::int32_t>(b);
      place_of_[grain_[k]] = k;
    }
  bodies.resize(count);
  step_.resize(count);
  mass_.resize(count);
  centre_.resize(count);
  inertia_.resize(count);
  inverse_.resize(count);
  for (VecField* field : {&offset_, &turn_, &next_turn_}) field->assign(grain_.size(), Vec{});
}

void Clumps::build(const Domain& domain, engine::Motion& motion, Rotation& rotation) {
  for (std::size_t b = 0; b < bodies.size(); ++b) {
    Vec moment{};
    double mass = 0.0;
    const auto place = [&](std::int32_t k) { return motion.position[grain_[k]] + domain.offset(image_[k]); };
    const Vec near = place(start_[b]);  // far from the origin the differences keep their digits
    for (std::int32_t k = start_[b]; k < start_[b + 1]; ++k) {
      moment += splat(motion.mass[grain_[k]]) * (place(k) - near);
      mass += motion.mass[grain_[k]];
    }
    mass_[b] = mass;
    const Vec middle = moment / splat(mass);
    centre_[b] = near + middle;
    Matrix3d inertia = Matrix3d::Zero();
    for (std::int32_t k = start_[b]; k < start_[b + 1]; ++k) {
      const Vec s = offset_[k] = place(k) - near - middle;
      const std::int32_t i = grain_[k];
      inertia +=
          (motion.mass[i] * dot(s, s) + rotation.inertia[i]) * Matrix3d::Identity() - motion.mass[i] * outer(s, s);
    }
    inertia_[b] = columns_of(inertia);
    inverse_[b] = columns_of(inertia.inverse());
  }
  if (fresh_) {
    fresh_ = false;
    take_displacement(motion);
    take_velocity(motion, rotation);
    return;
  }
  state_changed();
  for (std::size_t b = 0; b < bodies.size(); ++b) turn_with(b, bodies[b].velocity, bodies[b].spin, motion, rotation);
}

void Clumps::state_changed() {
  for (std::size_t b = 0; b < bodies.size(); ++b)
    for (std::int32_t k = start_[b]; k < start_[b + 1]; ++k) turn_[k] = turn_of(bodies[b].attitude, offset_[k]);
}

void Clumps::take_displacement(engine::Motion& motion) {
  for (std::size_t b = 0; b < bodies.size(); ++b) {
    Vec moment{};
    for (const std::int32_t i : members(b)) moment += splat(motion.mass[i]) * motion.displacement[i];
    const Vec mean = moment / splat(mass_[b]);
    Matrix3d fit = Matrix3d::Zero(), spread = Matrix3d::Zero();
    bool rigid_shift = true;
    for (std::int32_t k = start_[b]; k < start_[b + 1]; ++k) {
      const std::int32_t i = grain_[k];
      const Vec own = motion.displacement[i] - mean;
      rigid_shift = rigid_shift && dot(own, own) == 0.0;
      fit += motion.mass[i] * outer(offset_[k], offset_[k] + own);
      spread += motion.mass[i] * outer(offset_[k], offset_[k]);
    }
    // members in a line do not show a turn about it: none is taken
    constexpr double thin = 1e-9;
    const Eigen::Vector3d widths =
        Eigen::SelfAdjointEigenSolver<Matrix3d>(spread, Eigen::EigenvaluesOnly).eigenvalues();
    if (widths(1) < thin * widths(2)) fit += thin * widths(2) * Matrix3d::Identity();
    bodies[b].displacement = mean;
    bodies[b].attitude = rigid_shift ? Quaternion{1.0, 0.0, 0.0, 0.0} : best_rotation(fit);
  }
  state_changed();
  for (std::size_t b = 0; b < bodies.size(); ++b) put_members(b, motion);
}

void Clumps::take_velocity(engine::Motion& motion, Rotation& rotation) {
  for (std::size_t b = 0; b < bodies.size(); ++b) {
    Vec linear{}, angular{};
    for (std::int32_t k = start_[b]; k < start_[b + 1]; ++k) {
      const std::int32_t i = grain_[k];
      const Vec p = splat(motion.mass[i]) * motion.velocity[i];
      linear += p;
      angular += cross(offset_[k] + turn_[k], p) + splat(rotation.inertia[i]) * rotation.spin[i];
    }
    turn_with(b, linear / splat(mass_[b]), times(inverse_inertia(b), angular), motion, rotation);
  }
}

void Clumps::take_spin(engine::Motion& motion, Rotation& rotation) {
  for (std::size_t b = 0; b < bodies.size(); ++b) {
    Vec total{};
    for (const std::int32_t i : members(b)) total += splat(motion.mass[i]) * rotation.spin[i];
    turn_with(b, bodies[b].velocity, total / splat(mass_[b]), motion, rotation);
  }
}

void Clumps::take_angle(Rotation& rotation) const {
  for (std::size_t b = 0; b < bodies.size(); ++b) {
    Vec total{};
    for (const std::int32_t i : members(b)) total += rotation.angle[i];
    for (const std::int32_t i : members(b)) rotation.angle[i] = total / splat(static_cast<double>(members(b).size()));
  }
}

/// Gives the body this motion, and its members the velocities that belong to it.
void Clumps::turn_with(std::size_t b, Vec velocity, Vec spin, engine::Motion& motion, Rotation& rotation) {
  Body& body = bodies[b];
  body.velocity = velocity;
  body.spin = spin;
  const auto axes = axes_of(body.attitude);
  const Vec own = vec(dot(axes[0], spin), dot(axes[1], spin), dot(axes[2], spin));
  body.momentum = times(axes, times(inertia_[b], own));
  for (std::int32_t k = start_[b]; k < start_[b + 1]; ++k) {
    motion.velocity[grain_[k]] = velocity + cross(spin, offset_[k] + turn_[k]);
    rotation.spin[grain_[k]] = spin;
  }
}

}  // namespace gabion::dem
