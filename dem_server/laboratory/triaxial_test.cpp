#include "dem_server/laboratory/triaxial_test.hpp"

#include <algorithm>
#include <cmath>
#include <string>

namespace gabion::dem {
namespace {

using engine::RequestError;

/// Steps between looks at the state of the sample.
constexpr std::uint64_t look_every = 200;
/// Share of the confinement within which a stress counts as reached; and to which it is taken when rest does not come.
constexpr double stress_reached = 1e-3, stress_accepted = 1e-2;
/// Bounds on the cell's rate as inertial numbers: while confining, and of the lateral axes over the axial one's.
constexpr double confining_number = 1e-2;
constexpr double lateral_bound = 20.0;
/// Steps over which the pressure is brought up.
constexpr double ramp_steps = 2000.0;
/// Steps in which the axial rate comes near a new value.
constexpr double rate_steps = 300.0;
/// Energies are looked at so often.
constexpr std::uint64_t measure_every = 500;

struct NoPartner : engine::Exchange {
  void send_gap(std::span<const double>) override {}
  bool receive_multipliers(std::span<double>) override { return true; }
};

void need(bool sound, const char* field, double value, const char* advice) {
  if (!sound) throw RequestError(field, "it is " + std::to_string(value), advice);
}

}  // namespace

/// Running means of one point of the curve.
struct TriaxialTest::Sums {
  CurvePoint total;
  double count = 0.0;
  void add(double axial, double volume, Vec pressure, int axis, const int (&lateral)[2]) {
    total.axial_strain += axial;
    total.volume_strain += volume;
    total.axial_stress += pressure[axis];
    for (int k = 0; k < 2; ++k) total.lateral_stress[k] += pressure[lateral[k]];
    count += 1.0;
  }
  CurvePoint mean() const {
    CurvePoint point = total;
    for (double* value : {&point.axial_strain, &point.volume_strain, &point.axial_stress, &point.lateral_stress[0],
                          &point.lateral_stress[1]})
      *value /= count;
    return point;
  }
};

TriaxialTest::TriaxialTest(DemEngine& engine, const Confinement& confinement)
    : engine_(engine), confinement_(confinement) {
  need(confinement.pressure > 0.0 && std::isfinite(confinement.pressure), "TRIAXIAL_CONFINE.pressure",
       confinement.pressure, "give a pressure above 0");
  need(confinement.axis >= 0 && confinement.axis < 3, "TRIAXIAL_CONFINE.axis", confinement.axis, "give 0, 1 or 2");
  need(confinement.damping >= 0.0 && confinement.damping < 1.0, "TRIAXIAL_CONFINE.damping", confinement.damping,
       "give 0 to below 1");
  need(confinement.unbalanced > 0.0, "TRIAXIAL_CONFINE.unbalanced", confinement.unbalanced, "give a share above 0");
  need(confinement.step_fraction > 0.0 && confinement.step_fraction <= 1.0, "TRIAXIAL_CONFINE.step_fraction",
       confinement.step_fraction, "give a share of the stable step, up to 1");
  lateral_[0] = (confinement.axis + 1) % 3;
  lateral_[1] = (confinement.axis + 2) % 3;
  engine_.allow_stretch();
  const Grains& grains = engine_.grains();
  double mass = 0.0, solid = 0.0;
  for (std::size_t i = 0; i < grains.size(); ++i) {
    mass += grains.plain_mass(i);
    solid += grains.plain_mass(i) / grains.material_of(i).density;
  }
  density_ = mass / solid;
  box_ = engine_.domain().hi - engine_.domain().lo;
}

CurvePoint TriaxialTest::confine() {
  const double wanted = confinement_.pressure;
  choose_step(confinement_.damping);
  servo_.emplace(affine_stiffness(), dt_, mean_rate(confining_number));
  const std::uint64_t last = steps_ + confinement_.most_steps;
  double ramp = 0.0;
  for (std::uint64_t k = 1;; ++k) {
    const bool look = k % look_every == 0;
    step(confinement_.damping, look);
    ramp = std::min(1.0, ramp + 1.0 / ramp_steps);
    const Vec now = pressure();
    apply(servo_->rate(now, ramp * wanted, dt_));
    if (!look) continue;
    servo_->set_stiffness(affine_stiffness());
    double miss = 0.0;
    for (int axis = 0; axis < 3; ++axis) miss = std::max(miss, std::fabs(now[axis] / wanted - 1.0));
    const bool rests = engine_.unbalanced() < confinement_.unbalanced;
    if (ramp == 1.0 && miss < stress_reached && rests) break;
    if (steps_ < last) continue;
    if (miss < stress_accepted) break;  // grains without friction never come wholly to rest
    throw engine::PhysicsError("TRIAXIAL_CONFINE",
                               "the stress is " + std::to_string(100.0 * miss) + " % off the confinement after " +
                                   std::to_string(confinement_.most_steps) + " steps",
                               "allow more steps, more damping, or look whether the bonds carry the confinement");
  }
  box_ = engine_.domain().hi - engine_.domain().lo;
  axial_ = 0.0;
  confined_ = true;
  CurvePoint point;
  const Vec now = pressure();
  point.axial_stress = now[confinement_.axis];
  for (int k = 0; k < 2; ++k) point.lateral_stress[k] = now[lateral_[k]];
  add_counts(point);
  return point;
}

void TriaxialTest::check(const Shearing& request) const {
  if (!confined_) throw RequestError("TRIAXIAL_SHEAR", "the sample is not confined", "send TRIAXIAL_CONFINE first");
  need(request.axial_strain > axial_ && request.axial_strain < 0.9, "TRIAXIAL_SHEAR.axial_strain", request.axial_strain,
       "give a strain beyond the present one, below 0.9");
  need(request.record_every > 0.0, "TRIAXIAL_SHEAR.record_every", request.record_every, "give a strain above 0");
  need(request.inertial_number > 0.0 && request.inertial_number <= 0.1, "TRIAXIAL_SHEAR.inertial_number",
       request.inertial_number, "give 1e-5 to 0.1; below 1e-3 is quasi-static");
  need(request.damping >= 0.0 && request.damping < 1.0, "TRIAXIAL_SHEAR.damping", request.damping, "give 0 to below 1");
}

std::vector<CurvePoint> TriaxialTest::shear(const Shearing& request) {
  check(request);
  choose_step(request.damping);
  const double aim = mean_rate(request.inertial_number), volume_at_start = box_[0] * box_[1] * box_[2];
  const double approach = 1.0 - std::exp(-1.0 / rate_steps);
  servo_->set_largest_rate(lateral_bound * aim);
  std::vector<CurvePoint> curve;
  Sums sums;
  // the last point lies at the end, not a hair before it
  constexpr double hair = 0.01;
  const double end = request.axial_strain;
  const auto after = [&](double strain) {
    return end - strain > (1.0 + hair) * request.record_every ? strain + request.record_every : end;
  };
  double next = after(axial_);
  while (axial_ < end) {
    step(request.damping, steps_ % measure_every == 0);
    const Vec now = pressure();
    sums.add(axial_, 1.0 - volume() / volume_at_start, now, confinement_.axis, lateral_);
    rate_ += approach * (aim - rate_);
    Vec rate = servo_->rate(now, confinement_.pressure, dt_);
    rate[confinement_.axis] = -rate_ / (1.0 - axial_);  // of the present length
    apply(rate);
    if (steps_ % look_every == 0) servo_->set_stiffness(affine_stiffness());
    axial_ = 1.0 - engine_.domain().period(confinement_.axis) / box_[confinement_.axis];
    if (axial_ < next) continue;
    curve.push_back(sums.mean());
    add_counts(curve.back());
    sums = Sums{};
    next = after(next);
  }
  return curve;
}

void TriaxialTest::choose_step(double damping) {
  // local damping acts like a mass smaller by 1 + damping where force and velocity are opposed
  const double limit = confinement_.step_fraction * engine_.stable_step() / std::sqrt(1.0 + damping);
  if (dt_ == 0.0 || limit < dt_) dt_ = limit;
}

void TriaxialTest::step(double damping, bool measure) {
  NoPartner nobody;
  engine_.step({time_, dt_, damping, measure}, nobody);
  engine_.current_step = ++steps_;
  time_ += dt_;
  work_.add(0.5 * dot(engine_.virial(), strain_), 0.0);
  if (measure) measure_energy();
}

Vec TriaxialTest::pressure() const {
  return splat(-1.0 / volume()) * engine_.virial();
}

double TriaxialTest::volume() const {
  const Domain box = engine_.domain();
  return box.period(0) * box.period(1) * box.period(2);
}

/// 1/V sum over contacts of (k_n n_a^4 + k_s n_a^2 (1 - n_a^2)) d^2.
Vec TriaxialTest::affine_stiffness() const {
  const ContactTable& table = engine_.contacts();
  const engine::VecField& u = engine_.motion.displacement;
  Vec total{};
  table.each([&](std::size_t i, std::size_t c) {
    if (!(table.state[c] & (bonded | touching))) return;
    const Reach reach = reach_of(table, c, u[table.second[c]] - u[i]);
    const ContactSpring& k = table.stiffness[c];
    const Vec square = reach.branch * reach.branch / splat(reach.distance * reach.distance);
    total += splat(reach.distance * reach.distance) * square *
             (splat(k.normal) * square + splat(k.shear) * (splat(1.0) - square));
  });
  total /= splat(volume());
  // a sample without contacts has no stiffness yet: what two grains in series give then bounds the servo
  const Grains& grains = engine_.grains();
  double floor = 0.0;
  for (const GrainMaterial& m : grains.materials) floor = std::max(floor, m.normal_stiffness);
  constexpr double least = 0.01;
  for (int axis = 0; axis < 3; ++axis) total[axis] = std::max(total[axis], least * floor);
  return total;
}

double TriaxialTest::mean_rate(double inertial_number) const {
  const double diameter = 2.0 * engine_.grains().mean_radius();
  return inertial_number / diameter * std::sqrt(confinement_.pressure / density_);
}

void TriaxialTest::apply(Vec rate) {
  strain_ = splat(dt_) * rate;
  work_.add(0.0, 0.5 * dot(engine_.virial(), strain_));
  engine_.stretch(strain_);
}

void TriaxialTest::add_counts(CurvePoint& point) const {
  double contacts = 0.0, slides = 0.0;
  for (const std::uint8_t state : engine_.contacts().state) {
    if (!(state & (bonded | touching))) continue;
    contacts += 1.0;
    if (state & sliding) slides += 1.0;
  }
  for (const engine::NamedCount& count : engine_.counters())
    if (count.name == "broken") point.broken = count.value;
  point.contacts = 2.0 * contacts / static_cast<double>(engine_.grains().size());
  point.sliding = contacts > 0.0 ? slides / contacts : 0.0;
}

void TriaxialTest::measure_energy() {
  if (!engine_.motion.measured) return;
  const engine::Ledger ledger = engine_.ledger();
  const double balance = ledger.balance() - work_.until_now();
  if (!first_balance_) first_balance_ = balance;
  error_ = balance - *first_balance_;
  double stored = 0.0, lost = 0.0;
  for (const auto& entry : ledger.entries) {
    if (entry.kind == engine::Ledger::Kind::stored) stored += entry.energy;
    if (entry.kind == engine::Ledger::Kind::lost) lost += entry.energy;
  }
  for (const double energy : {stored, lost, work_.until_now()})
    largest_energy_ = std::max(largest_energy_, std::fabs(energy));
}

SampleState TriaxialTest::state() {
  const Domain box = engine_.domain();
  SampleState now;
  now.box = box.hi - box.lo;
  now.stress = pressure();
  now.step = dt_;
  now.steps = steps_;
  now.unbalanced = engine_.unbalanced();
  now.work = work_.until_now();
  now.energy_error = error_;
  now.largest_energy = largest_energy_;
  return now;
}

}  // namespace gabion::dem
