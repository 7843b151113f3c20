// Linear bonded spheres (linearised contact of Cundall & Strack 1979).
//
//   delta = u_j - u_i - (a_i theta_i + a_j theta_j) x n        relative displacement at the contact [m]
//   f     = k_s delta + (k_n - k_s)(delta.n) n                 force on i, -f on j [N]
//   T_i   = a_i n x f,   T_j = a_j n x f                       torques [N m]
//
//   a_i + a_j = distance at rest, so that the angular momentum is kept.

#include "dem_server/linear_network.hpp"

#include "dem_server/vector_kernels.hpp"

namespace gabion::dem {
namespace {

struct Pull {
  Vec normal, force;
};

template <bool rotating>
inline Pull pull(const LinearContact& c, Vec du, Vec angle_i, Vec angle_j) {
  const Vec n = without_fourth(c.normal);
  Vec delta = du;
  if constexpr (rotating) delta -= cross_of(fma(splat(c.arm_i), angle_i, splat(c.arm_j) * angle_j), n);
  return {n, fma(splat(c.normal[3]), delta, (splat(c.excess) * dot_all(delta, n)) * n)};
}

/// One thread: forces go straight to the grains.
template <bool rotating>
void scatter(std::size_t first, std::size_t last, const std::int32_t* start, const std::int32_t* second,
             const LinearContact* contacts, const Vec* u, const Vec* angle, Vec* force, Vec* torque) {
  for (std::size_t i = first; i < last; ++i) {
    const Vec ui = u[i], wi = rotating ? angle[i] : Vec{};
    Vec fi = force[i], ti = rotating ? torque[i] : Vec{};
    for (std::int32_t k = start[i]; k < start[i + 1]; ++k) {
      const auto j = static_cast<std::size_t>(second[k]);
      const LinearContact& c = contacts[k];
      const Pull p = pull<rotating>(c, u[j] - ui, wi, rotating ? angle[j] : Vec{});
      fi += p.force;
      Vec moment;
      if constexpr (rotating) {
        moment = cross_of(p.normal, p.force);
        ti = fma(splat(c.arm_i), moment, ti);
      }
      if (j == i) [[unlikely]] {  // a grain that meets its own image
        fi -= p.force;
        if constexpr (rotating) ti = fma(splat(c.arm_j), moment, ti);
        continue;
      }
      force[j] -= p.force;
      if constexpr (rotating) torque[j] = fma(splat(c.arm_j), moment, torque[j]);
    }
    force[i] = fi;
    if constexpr (rotating) torque[i] = ti;
  }
}

/// Several threads: forces are kept per contact.
template <bool rotating>
void keep(std::size_t first, std::size_t last, const std::vector<std::int32_t>& start,
          const std::vector<std::int32_t>& second, const std::vector<LinearContact>& contacts, const VecField& u,
          const VecField& angle, PairBuffer& buffer, int threads) {
#pragma omp parallel for schedule(static) num_threads(threads)
  for (std::size_t i = first; i < last; ++i)
    for (std::int32_t k = start[i]; k < start[i + 1]; ++k) {
      const auto j = static_cast<std::size_t>(second[k]);
      const LinearContact& c = contacts[k];
      const Pull p = pull<rotating>(c, u[j] - u[i], rotating ? angle[i] : Vec{}, rotating ? angle[j] : Vec{});
      Vec force = p.force;
      force[3] = c.arm_i;
      buffer.force[k] = force;
      if constexpr (rotating) {
        Vec moment = cross_of(p.normal, p.force);
        moment[3] = c.arm_j;
        buffer.moment[k] = moment;
      }
    }
}

/// f = -k_s u_t - k_n u_n at the end of the arm; the surface stands still.
void add_surface_forces(const std::vector<SurfaceSpring>& springs, const VecField& u, const VecField& angle,
                        VecField& force, VecField& torque, bool rotating) {
  for (const SurfaceSpring& s : springs) {
    Vec delta = -u[s.grain];
    if (rotating) delta -= cross(splat(s.arm) * angle[s.grain], s.normal);
    const Vec f = splat(s.shear_stiffness) * delta +
                  splat((s.normal_stiffness - s.shear_stiffness) * dot(delta, s.normal)) * s.normal;
    force[s.grain] += f;
    if (rotating) torque[s.grain] += splat(s.arm) * cross(s.normal, f);
    if (rotating && s.rolling_stiffness > 0.0)
      torque[s.grain] -= splat(s.rolling_stiffness) * (angle[s.grain] - splat(dot(angle[s.grain], s.normal)) * s.normal);
  }
}

/// Whether rolling resistance or dashpots act here, or will once a bond is broken.
bool dissipates(const ContactTable& table, std::size_t c, double elongation, double near) {
  return table.state[c] & bonded ? !table.strength.empty() : elongation <= near;
}

}  // namespace

void LinearNetwork::build(const ContactTable& table, const VecField& u, double near) {
  start_.assign(1, 0);
  second_.clear();
  contacts_.clear();
  connected_ = false;
  for (std::size_t i = 0; i < table.grains(); ++i) {
    for (std::int32_t c = table.start[i]; c < table.start[i + 1]; ++c) {
      const std::int32_t j = table.second[c];
      const Reach reach = reach_of(table, c, u[j] - u[i]);
      if (!(table.state[c] & bonded) && reach.elongation > near) continue;
      take(table, c, reach, table.stiffness[c].normal, table.stiffness[c].shear);
    }
    start_.push_back(static_cast<std::int32_t>(second_.size()));
  }
}

void LinearNetwork::take(const ContactTable& table, std::size_t c, const Reach& reach, double normal, double shear) {
  Vec direction = reach.branch / splat(reach.distance);
  direction[3] = shear;
  const double half_difference = table.stiffness[c].half_difference;
  contacts_.push_back(
      {direction, 0.5 * reach.distance + half_difference, 0.5 * reach.distance - half_difference, normal - shear});
  second_.push_back(table.second[c]);
}

void LinearNetwork::add_rolling(const ContactTable& table, const VecField& u, double near) {
  table.each([&](std::size_t i, std::size_t c) {
    const std::int32_t j = table.second[c];
    const Reach reach = reach_of(table, c, u[j] - u[i]);
    if (!dissipates(table, c, reach.elongation, near) || !(table.rolling[c].stiffness > 0.0)) return;
    rolling_.push_back(
        {static_cast<std::int32_t>(i), j, reach.branch / splat(reach.distance), table.rolling[c].stiffness});
  });
}

void LinearNetwork::build_dashpots(const ContactTable& table, const VecField& u, double near,
                                   std::vector<SurfaceSpring> surfaces) {
  *this = LinearNetwork{};
  for (std::size_t i = 0; i < table.grains(); ++i) {
    for (std::int32_t c = table.start[i]; c < table.start[i + 1]; ++c) {
      const Reach reach = reach_of(table, c, u[table.second[c]] - u[i]);
      if (dissipates(table, c, reach.elongation, near))
        take(table, c, reach, table.damper[c].normal, table.damper[c].shear);
    }
    start_.push_back(static_cast<std::int32_t>(second_.size()));
  }
  for (SurfaceSpring& s : surfaces) {
    s.normal_stiffness = s.damper.normal;
    s.shear_stiffness = s.damper.shear;
    s.rolling_stiffness = 0.0;
  }
  add_surface(std::move(surfaces));
}

/// M = k_r P (theta_j - theta_i)
void LinearNetwork::add_couples(const VecField& angle, VecField& torque) const {
  for (const RollingSpring& s : rolling_) {
    const Vec bent = angle[s.j] - angle[s.i];
    const Vec couple = splat(s.stiffness) * (bent - splat(dot(bent, s.normal)) * s.normal);
    torque[s.i] += couple;
    torque[s.j] -= couple;
  }
}

void LinearNetwork::add_forces(std::size_t first, std::size_t last, const VecField& displacement, const VecField& angle,
                               VecField& force, VecField& torque, bool rotating, int threads) {
  if (threads <= 1) {
    const auto run = rotating ? scatter<true> : scatter<false>;
    run(first, last, start_.data(), second_.data(), contacts_.data(), displacement.data(), angle.data(), force.data(),
        torque.data());
  } else {
    if (!connected_) {
      buffer_.connect(start_, second_);
      connected_ = true;
    }
    const auto run = rotating ? keep<true> : keep<false>;
    run(first, last, start_, second_, contacts_, displacement, angle, buffer_, threads);
    buffer_.gather(first, last, rotating, force, torque, threads);
  }
  if (!surface_.empty() && last + 1 == start_.size())
    add_surface_forces(surface_, displacement, angle, force, torque, rotating);
  if (!rolling_.empty() && rotating && last + 1 == start_.size()) add_couples(angle, torque);
}

Vec LinearNetwork::force(std::size_t i, std::size_t c, const VecField& displacement, const VecField& angle,
                         bool rotating) const {
  const auto j = static_cast<std::size_t>(second_[c]);
  const Vec du = displacement[j] - displacement[i];
  return rotating ? pull<true>(contacts_[c], du, angle[i], angle[j]).force
                  : pull<false>(contacts_[c], du, Vec{}, Vec{}).force;
}

double LinearNetwork::energy(const VecField& displacement, const VecField& angle, bool rotating) const {
  double twice = 0.0;
  for (std::size_t i = 0; i + 1 < start_.size(); ++i)
    for (std::int32_t c = start_[i]; c < start_[i + 1]; ++c) {
      const std::int32_t j = second_[c];
      Vec delta = displacement[j] - displacement[i];
      const Vec n = without_fourth(contacts_[c].normal);
      if (rotating) delta -= cross(splat(contacts_[c].arm_i) * angle[i] + splat(contacts_[c].arm_j) * angle[j], n);
      const double along = dot(delta, n);
      twice += contacts_[c].normal[3] * dot(delta, delta) + contacts_[c].excess * along * along;
    }
  return 0.5 * twice;
}

}  // namespace gabion::dem
