#include "dem_server/block.hpp"

#include <Eigen/Eigenvalues>
#include <cmath>
#include <stdexcept>

namespace gabion::dem {
namespace {

Quaternion product(const Quaternion& a, const Quaternion& b) {
  return {a[0] * b[0] - a[1] * b[1] - a[2] * b[2] - a[3] * b[3], a[0] * b[1] + a[1] * b[0] + a[2] * b[3] - a[3] * b[2],
          a[0] * b[2] - a[1] * b[3] + a[2] * b[0] + a[3] * b[1], a[0] * b[3] + a[1] * b[2] - a[2] * b[1] + a[3] * b[0]};
}

Quaternion quaternion_of(const Eigen::Matrix3d& axes) {
  const Eigen::Quaterniond q(axes);
  return {q.w(), q.x(), q.y(), q.z()};
}

Vec to_body(const std::array<Vec, 3>& axes, Vec x) {
  return vec(dot(x, axes[0]), dot(x, axes[1]), dot(x, axes[2]));
}
Vec to_space(const std::array<Vec, 3>& axes, Vec x) {
  return splat(x[0]) * axes[0] + splat(x[1]) * axes[1] + splat(x[2]) * axes[2];
}

/// Local damping: -alpha |F| sign(v), by component.
Vec drag(double alpha, Vec force, Vec velocity) {
  Vec d{};
  for (int axis = 0; axis < 3; ++axis)
    if (velocity[axis] != 0.0) d[axis] = -std::copysign(alpha * std::fabs(force[axis]), velocity[axis]);
  return d;
}

/// Share given to the grains when block and grains are decoupled for the stable step.
constexpr double split = 0.1;

}  // namespace

std::array<Vec, 3> axes_of(const Quaternion& q) {
  const auto [w, x, y, z] = q;
  return {vec(1 - 2 * (y * y + z * z), 2 * (x * y + w * z), 2 * (x * z - w * y)),
          vec(2 * (x * y - w * z), 1 - 2 * (x * x + z * z), 2 * (y * z + w * x)),
          vec(2 * (x * z + w * y), 2 * (y * z - w * x), 1 - 2 * (x * x + y * y))};
}

Quaternion turned(const Quaternion& q, Vec angle) {
  const double half = 0.5 * norm(angle);
  const double ratio = half > 0.0 ? 0.5 * std::sin(half) / half : 0.5;
  Quaternion r = product({std::cos(half), ratio * angle[0], ratio * angle[1], ratio * angle[2]}, q);
  const double length = std::sqrt(r[0] * r[0] + r[1] * r[1] + r[2] * r[2] + r[3] * r[3]);
  for (double& c : r) c /= length;
  return r;
}

void Block::set(const BlockSetup& setup) {
  if (!(setup.mass > 0.0)) throw std::invalid_argument("the mass must be above 0");
  if (!(setup.friction >= 0.0)) throw std::invalid_argument("the friction must not be negative");
  body_ = Polyhedron(setup.vertices, setup.face_ptr, setup.face_vertices);
  Eigen::Matrix3d inertia;
  for (int p = 0; p < 3; ++p)
    for (int q = 0; q < 3; ++q) inertia(p, q) = body_.inertia[p][q];
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> principal(inertia);
  Eigen::Matrix3d axes = principal.eigenvectors();
  if (axes.determinant() < 0.0) axes.col(2) *= -1.0;

  mass_ = setup.mass;
  friction_ = setup.friction;
  rotates_ = setup.rotation;
  start_ = body_.centroid;
  for (int p = 0; p < 3; ++p) inertia_[p] = mass_ * principal.eigenvalues()(p);
  now = {};
  now.attitude = quaternion_of(axes);
  now.velocity = setup.velocity;
  const auto body_axes = axes_of(now.attitude);
  if (rotates_) now.momentum = to_space(body_axes, inertia_ * to_body(body_axes, setup.spin));
  body_.move_to_axes(start_, body_axes.data());
  radius_ = body_.radius();
  now.spin = old_spin_ = spin_at(now.attitude);
  old_velocity_ = now.velocity;
  contacts.clear();
  losses = {};
  damping_work = {};
  kicks_ = 0;
}

Vec Block::spin_at(const Quaternion& q) const {
  if (!rotates_) return Vec{};
  const auto axes = axes_of(q);
  Vec body = to_body(axes, now.momentum);
  for (int p = 0; p < 3; ++p) body[p] /= inertia_[p];
  return to_space(axes, body);
}

void Block::find(const ContactSource& source, const VecField& displacement, double margin) {
  std::vector<SurfaceContact> found;
  const auto axes = axes_of(now.attitude);
  auto old = contacts.begin();
  for (std::size_t i = 0; i < source.grains.size(); ++i) {
    const double radius = source.grains.radius[i];
    const Vec from = source.domain.shift(source.rest[i] + displacement[i] - position());
    if (norm(from) > radius_ + radius + margin) continue;
    const NearestPoint near = nearest_point(body_, to_body(axes, from));
    if (near.distance - radius > margin) continue;
    const auto grain = static_cast<std::int32_t>(i);
    while (old != contacts.end() && old->grain < grain) ++old;
    if (old != contacts.end() && old->grain == grain) {
      found.push_back(*old);
      continue;
    }
    SurfaceContact contact;
    contact.grain = grain;
    set_parameters(contact, source.grains, i, friction_, mass_, source.weights.at(source.rest[i]));
    contact.normal = -to_space(axes, near.outward);
    contact.elongation = near.distance - radius;
    found.push_back(contact);
  }
  contacts = std::move(found);
  now.displacement_at_find = now.displacement;
  now.angle_at_find = now.angle_travelled;
}

double Block::largest_travel() const {
  return norm(now.displacement - now.displacement_at_find) + radius_ * (now.angle_travelled[0] - now.angle_at_find[0]);
}

void Block::add_forces(const Grains& grains, const Domain& domain, double past_step, engine::Motion& motion,
                       Rotation& rotation, bool rotating) {
  force_ = torque_ = Vec{};
  const auto axes = axes_of(now.attitude);
  for (SurfaceContact& c : contacts) {
    const double radius = grains.radius[c.grain];
    const Vec from =
        domain.shift(motion.position[c.grain] - start_ + (motion.displacement[c.grain] - now.displacement));
    const NearestPoint near = nearest_point(body_, to_body(axes, from));
    const double e = near.distance - radius;
    if (!(c.state & touching) && !(e < 0.0)) {
      c.elongation = e;
      c.force = Vec{};
      continue;
    }
    const Vec n = -to_space(axes, near.outward);
    const Vec lever = splat(contact_arm(radius, e)) * n;
    const Vec block_lever = from + lever;
    Vec slip = now.velocity + cross(now.spin, block_lever) - motion.velocity[c.grain];
    Vec mean = now.spin, spin = now.spin;
    if (rotating) {
      slip -= cross(rotation.spin[c.grain], lever);
      mean += rotation.spin[c.grain];
      spin -= rotation.spin[c.grain];
    }
    losses += follow_surface(c, {e, n, slip, 0.5 * dot(mean, n), spin}, past_step);
    if (!(c.state & touching)) continue;
    motion.force[c.grain] += c.force;
    if (rotating) rotation.torque[c.grain] += cross(lever, c.force) + c.couple();
    force_ -= c.force;
    torque_ -= cross(block_lever, c.force) + c.couple();
  }
}

void Block::kick(const engine::StepContext& context, Vec gravity) {
  const Vec dt = splat(context.dt);
  const Vec force = force_ + splat(mass_) * gravity;
  recent_[kicks_++ % remembered_forces] = force_;
  old_velocity_ = now.velocity;
  old_spin_ = now.spin;
  damping_force_ = damping_torque_ = Vec{};
  if (context.damping > 0.0) {
    damping_force_ = drag(context.damping, force, now.velocity);
    if (rotates_) damping_torque_ = drag(context.damping, torque_, now.spin);
  }
  now.velocity += dt * (force + damping_force_) / splat(mass_);
  if (!rotates_) return;
  now.momentum += dt * (torque_ + damping_torque_);
  const Quaternion half = turned(now.attitude, splat(0.5 * context.dt) * spin_at(now.attitude));
  now.spin = spin_at(half);
}

void Block::drift(const engine::StepContext& context) {
  const double half = 0.5 * context.dt;
  damping_work.add(half * (dot(damping_force_, old_velocity_) + dot(damping_torque_, old_spin_)),
                   half * (dot(damping_force_, now.velocity) + dot(damping_torque_, now.spin)));
  now.displacement += splat(context.dt) * now.velocity;
  if (!rotates_) return;
  const Vec angle = splat(context.dt) * now.spin;
  now.attitude = turned(now.attitude, angle);
  now.angle_travelled[0] += norm(angle);
}

double Block::kinetic_energy() const {
  return 0.5 * mass_ * dot(old_velocity_, now.velocity);
}
double Block::rotational_energy() const {
  return 0.5 * dot(old_spin_, now.momentum);
}
double Block::gravity_energy(Vec gravity) const {
  return -mass_ * dot(gravity, now.displacement);
}

double Block::power_before(Vec gravity) const {
  return dot(force_ + splat(mass_) * gravity, old_velocity_) + (rotates_ ? dot(torque_, old_spin_) : 0.0);
}

std::vector<double> Block::momentum() const {
  const Vec linear = splat(mass_) * now.velocity;
  const Vec angular = cross(position(), linear) + now.momentum;
  return {linear[0], linear[1], linear[2], angular[0], angular[1], angular[2], norm(linear)};
}

double Block::elastic_energy() const {
  double total = 0.0;
  for (const SurfaceContact& c : contacts) total += c.energy();
  return total;
}

Spectra Block::add_springs(const Grains& grains, double near, std::vector<SurfaceSpring>& springs) const {
  if (!present()) return {};
  double stiffness = 0.0, bending = 0.0, viscosity = 0.0;
  for (const SurfaceContact& c : contacts) {
    if (c.elongation > near) continue;
    const double arm = contact_arm(grains.radius[c.grain], std::min(c.elongation, 0.0)), more = 1.0 + split;
    springs.push_back({c.grain,
                       c.normal,
                       arm,
                       more * c.stiffness.normal,
                       more * c.stiffness.shear,
                       more * c.rolling.stiffness,
                       {more * c.damper.normal, more * c.damper.shear}});
    stiffness += std::max(c.stiffness.normal, c.stiffness.shear);
    bending += c.rolling.stiffness;
    viscosity += std::max(c.damper.normal, c.damper.shear);
  }
  const double least = std::min({inertia_[0], inertia_[1], inertia_[2]});
  const double mobility = 1.0 / mass_ + (rotates_ ? radius_ * radius_ / least : 0.0), share = 1.0 + 1.0 / split;
  return {share * (stiffness * mobility + (rotates_ ? bending / least : 0.0)), share * viscosity * mobility};
}

std::vector<double> Block::state() const {
  std::vector<double> all;
  const auto append = [&](Vec a) {
    for (int axis = 0; axis < 3; ++axis) all.push_back(a[axis]);
  };
  append(position());
  append(now.velocity);
  for (const double component : now.attitude) all.push_back(component);
  append(now.spin);
  append(force_);
  append(torque_);
  const auto axes = axes_of(now.attitude);
  for (const Vec v : body_.vertices) append(position() + to_space(axes, v));
  return all;
}

VecField Block::recent_forces() const {
  VecField forces;
  const std::size_t count = std::min(kicks_, remembered_forces);
  for (std::size_t k = kicks_ - count; k < kicks_; ++k) forces.push_back(recent_[k % remembered_forces]);
  return forces;
}

}  // namespace gabion::dem
