#include "dem_server/contact_forces.hpp"

#include <algorithm>

#include "dem_server/contact_loop.hpp"

namespace gabion::dem {
namespace {

/// Sums of losses run over blocks of this many grains, whatever the number of threads.
constexpr std::size_t block = 512;

using Loop = void (*)(const LoopArrays&, std::size_t, std::size_t, ContactSums&);

template <class Law, class Parts>
Loop loop_with(bool scattering) {
  return scattering ? scatter_contacts<Law, Parts> : keep_contacts<Law, Parts>;
}

template <class Law>
Loop loop_of(const ContactForces& f, bool scattering) {
  if (!f.rotating)
    return f.damped ? loop_with<Law, LoopParts<false, false, true>>(scattering)
                    : loop_with<Law, LoopParts<false, false, false>>(scattering);
  if (f.rolling)
    return f.damped ? loop_with<Law, LoopParts<true, true, true>>(scattering)
                    : loop_with<Law, LoopParts<true, true, false>>(scattering);
  return f.damped ? loop_with<Law, LoopParts<true, false, true>>(scattering)
                  : loop_with<Law, LoopParts<true, false, false>>(scattering);
}

/// Loops of a ground that is strained between steps.
Loop choose_stretched(const ContactForces& f, bool scattering) {
  switch (f.law) {
    case LawKind::elastic_bond:
      return loop_of<Stretched<ElasticBond>>(f, scattering);
    case LawKind::breakable_bond:
      return loop_of<Stretched<BreakableBond>>(f, scattering);
    case LawKind::friction:
      break;
  }
  return loop_of<Stretched<Friction>>(f, scattering);
}

Loop choose(const ContactForces& f, bool scattering) {
  switch (f.law) {
    case LawKind::elastic_bond:
      return loop_of<ElasticBond>(f, scattering);
    case LawKind::breakable_bond:
      return loop_of<BreakableBond>(f, scattering);
    case LawKind::friction:
      break;
  }
  return loop_of<Friction>(f, scattering);
}

}  // namespace

void ContactForces::table_changed(std::size_t grains) {
  broken_of.resize(grains, 0);
  broken_as_first.resize(grains, 0);
  if (threads > 1) buffer_.connect(table.start, table.second, rolling);
}

void ContactForces::add(std::size_t first, std::size_t last, double past_step, const Grains& grains,
                        engine::Motion& motion, Rotation& rotation) {
  if (first >= last) return;
  const bool scattering = threads <= 1;
  const Loop loop = (stretched ? choose_stretched : choose)(*this, scattering);
  const LoopArrays arrays{
      table.start.data(),     table.second.data(),   table.branch.data(),  table.spring.data(),
      table.stiffness.data(), table.strength.data(), table.state.data(),   motion.displacement.data(),
      motion.velocity.data(), rotation.spin.data(),  motion.force.data(),  rotation.torque.data(),
      buffer_.force.data(),   buffer_.moment.data(), grains.radius.data(), past_step,
      table.bending.data(),   buffer_.couple.data(), table.rolling.data(), table.drag.data(),
      table.damper.data(),    strain_rate,
      lever.empty() ? nullptr : lever.data()};
  const std::size_t blocks = (last - first + block - 1) / block;
  sums_.assign(blocks, ContactSums{});
#pragma omp parallel for schedule(static) num_threads(threads) if (threads > 1)
  for (std::size_t b = 0; b < blocks; ++b)
    loop(arrays, first + b * block, std::min(last, first + (b + 1) * block), sums_[b]);
  if (!scattering) buffer_.gather(first, last, rotating, motion.force, rotation.torque, threads);
  if (first == 0) virial = Vec{};
  for (std::size_t b = 0; b < blocks; ++b) {
    virial += sums_[b].virial;
    losses += sums_[b].losses;
    if (sums_[b].breaks > 0) book_breaks(first + b * block, std::min(last, first + (b + 1) * block));
  }
}

void ContactForces::book_breaks(std::size_t first, std::size_t last) {
  for (std::size_t i = first; i < last; ++i)
    for (std::int32_t c = table.start[i]; c < table.start[i + 1]; ++c) {
      std::uint8_t& state = table.state[c];
      if (!(state & broken) || (state & counted)) continue;
      state |= counted;
      ++breaks;
      ++broken_of[i];
      ++broken_of[table.second[c]];
      ++broken_as_first[i];
    }
}

void ContactForces::springs_from_displacements(const VecField& displacement, const VecField& angle) {
  table.each([&](std::size_t i, std::size_t c) {
    if (!(table.state[c] & bonded)) return;
    const auto j = static_cast<std::size_t>(table.second[c]);
    const Vec du = displacement[j] - displacement[i];
    const Reach reach = reach_of(table, c, du);
    const Vec n = reach.branch / splat(reach.distance);
    Vec slip = du;
    if (rotating) {
      const double share = table.stiffness[c].half_difference / reach.distance;
      const Vec turn = splat(0.5 + share) * angle[i] + splat(0.5 - share) * angle[j];
      slip -= cross(turn, reach.branch - splat(0.5) * du);
    }
    Vec spring = slip - n * splat(dot(slip, n));
    spring[3] = table.spring[c][3];
    table.spring[c] = spring;
  });
}

double ContactForces::energy(const VecField& displacement) const {
  double twice = 0.0;
  table.each([&](std::size_t i, std::size_t c) {
    if (!(table.state[c] & (bonded | touching))) return;
    const double e = reach_of(table, c, displacement[table.second[c]] - displacement[i]).elongation;
    const ContactSpring& k = table.stiffness[c];
    twice += k.normal * e * e + k.shear * dot(table.spring[c], table.spring[c]);
    if (rolling) twice += table.rolling[c].stiffness * dot(table.bending[c], table.bending[c]);
  });
  return 0.5 * twice;
}

Vec ContactForces::force(std::size_t i, std::size_t c, const VecField& displacement) const {
  const Reach reach = reach_of(table, c, displacement[table.second[c]] - displacement[i]);
  if (!(table.state[c] & bonded) && !(reach.elongation < 0.0)) return Vec{};
  const ContactSpring& k = table.stiffness[c];
  double tension = k.normal * reach.elongation;
  Vec f = splat(k.shear) * table.spring[c];
  if (damped && !(table.state[c] & bonded)) {
    tension = std::min(0.0, tension + table.drag[c][3]);
    f += table.drag[c];
  }
  f += splat(tension / reach.distance) * reach.branch;
  f[3] = 0.0;
  return f;
}

}  // namespace gabion::dem
