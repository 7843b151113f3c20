// DemEngine: checkpoints and the state's hash.

#include <string>

#include "dem_server/archive.hpp"
#include "dem_server/engine.hpp"
#include "protocol/engine/hash.hpp"

namespace gabion::dem {

/// Every member that a resumed run needs and prepare does not rebuild, in one order for both ways.
struct EngineState {
  template <typename Archive>
  static void visit(Archive& archive, DemEngine& e) {
    const auto all = [&](auto&... members) { (archive(members), ...); };
    engine::Motion& m = e.motion;
    all(m.displacement, m.velocity, m.force, m.tie_force, m.damping_work, m.dashpot_work);
    Rotation& r = e.rotation_;
    all(r.angle, r.spin, r.torque, r.damping_work);
    ContactTable& t = e.contact_.table;
    all(t.start, t.second, t.image, t.branch, t.spring, t.stiffness, t.strength, t.state);
    all(t.bending, t.rolling, t.drag, t.damper);
    ContactForces& c = e.contact_;
    all(c.losses, c.breaks, c.broken_of, c.broken_as_first);
    all(e.walls_.walls, e.walls_.contacts, e.walls_.losses, e.walls_.work);
    all(e.block_.now, e.block_.contacts, e.block_.losses, e.block_.damping_work);
    all(e.boundary.load_work, e.boundary.constraint_work, e.tie.work, e.sponge_.work);
    // rows that were set anew count displacements from another origin, and keep it
    VecField origin = e.tie.origin();
    all(origin);
    if (origin.size() == e.tie.reach()) e.tie.origin() = std::move(origin);
    std::uint64_t grouping = e.clumps_.grouping_key();
    all(grouping, e.clumps_.bodies, e.clumps_.damping_work);
    if (grouping != e.clumps_.grouping_key()) throw std::out_of_range("it is of other clumps");
    all(e.step_change_, e.displacement_at_build_, e.past_step_, e.steps_, e.rebuilds_, e.fast_, e.lost_);
  }
};

namespace {

/// What must agree between the engine that wrote a state and the one that reads it.
struct StateHeader {
  char magic[8] = {'g', 'a', 'b', 'd', 'e', 'm', '0', '3'};
  std::uint64_t grains = 0, walls = 0;
  std::uint8_t frozen = 0, rotating = 0, block = 0, law = 0, rolling = 0, damped = 0;
  std::uint8_t padding[2] = {};
};

}  // namespace

std::vector<std::uint8_t> DemEngine::checkpoint() const {
  if (contact_.stretched)
    throw engine::RequestError("CHECKPOINT", "the ground is strained by a laboratory test, whose state is not kept",
                               "send GRAINS, BONDS and PREPARE anew");
  StateHeader header;
  header.grains = grains_.size();
  header.walls = walls_.walls.size();
  header.frozen = contact_options_.geometry == Geometry::frozen;
  header.rotating = contact_options_.rotations;
  header.block = block_.present();
  header.law = static_cast<std::uint8_t>(contact_.law);
  header.rolling = contact_.rolling;
  header.damped = contact_.damped;
  StateWriter writer;
  writer(header);
  // the writer only reads; one list of members serves both ways
  EngineState::visit(writer, const_cast<DemEngine&>(*this));
  return std::move(writer.bytes);
}

void DemEngine::restore(std::span<const std::uint8_t> blob) {
  const char* advice = "set the engine up as the one that wrote the checkpoint, and send PREPARE first";
  StateHeader header, own;
  own.grains = grains_.size();
  own.walls = walls_.walls.size();
  own.frozen = contact_options_.geometry == Geometry::frozen;
  own.rotating = contact_options_.rotations;
  own.block = block_.present();
  own.law = static_cast<std::uint8_t>(contact_.law);
  own.rolling = contact_.rolling;
  own.damped = contact_.damped;
  if (!built_) throw engine::RequestError("RESTORE", "the engine is not prepared", advice);
  if (blob.size() < sizeof header)
    throw engine::RequestError("RESTORE blob", "it holds only " + std::to_string(blob.size()) + " bytes", advice);
  StateReader reader(blob);
  reader(header);
  if (std::memcmp(&header, &own, sizeof header) != 0)
    throw engine::RequestError("RESTORE blob",
                               "the state is of another engine or set-up: " + std::to_string(header.grains) +
                                   " grains here against " + std::to_string(own.grains),
                               advice);
  try {
    EngineState::visit(reader, *this);
  } catch (const std::out_of_range& error) {
    built_ = false;  // half a state is none
    throw engine::RequestError("RESTORE blob", error.what(), advice);
  }
  clumps_.state_changed();
  contact_.table_changed(grains_.size());
  step_size_ = 0.0;
}

std::uint64_t DemEngine::state_hash() const {
  engine::Hash hash;
  hash.add(std::span<const Vec>(motion.displacement));
  hash.add(std::span<const Vec>(motion.velocity));
  if (contact_options_.rotations) {
    hash.add(std::span<const Vec>(rotation_.angle));
    hash.add(std::span<const Vec>(rotation_.spin));
  }
  contact_.table.each([&](std::size_t, std::size_t c) {
    // near pairs that do not touch come and go with the search
    if (!(contact_.table.state[c] & (bonded | touching))) return;
    for (int axis = 0; axis < 3; ++axis) hash.add(contact_.table.spring[c][axis]);
    if (contact_.rolling)
      for (int axis = 0; axis < 3; ++axis) hash.add(contact_.table.bending[c][axis]);
  });
  for (const Clumps::Body& body : clumps_.bodies) {
    for (const Vec v : {body.displacement, body.velocity, body.momentum})
      for (int axis = 0; axis < 3; ++axis) hash.add(v[axis]);
    for (const double component : body.attitude) hash.add(component);
  }
  if (block_.present())
    for (const double value : block_.state()) hash.add(value);
  return hash.value();
}

}  // namespace gabion::dem
