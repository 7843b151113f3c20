// dem_server: the discrete-element engine behind the protocol.

#include <optional>

#include "dem_server/engine.hpp"
#include "dem_server/laboratory/triaxial_test.hpp"
#include "dem_server/packing/face_offset.hpp"
#include "dem_server/packing/homogenise.hpp"
#include "dem_server/packing/packing.hpp"
#include "protocol/messages.hpp"
#include "protocol/session/server.hpp"

namespace {

using namespace gabion;
using dem::Vec;

Vec to_vec(std::span<const double> v) {
  return engine::vec(v[0], v[1], v[2]);
}

engine::VecField to_field(const protocol::Array<double>& rows) {
  engine::VecField field(rows.rows());
  for (std::size_t i = 0; i < field.size(); ++i) field[i] = to_vec(rows.row(i));
  return field;
}

std::vector<double> flat(const engine::VecField& field) {
  std::vector<double> values;
  values.reserve(3 * field.size());
  for (const Vec v : field)
    for (int axis = 0; axis < 3; ++axis) values.push_back(v[axis]);
  return values;
}

std::vector<dem::GrainMaterial> to_materials(const protocol::GrainMaterials& m) {
  std::vector<dem::GrainMaterial> materials;
  for (std::size_t k = 0; k < m.density.size(); ++k)
    materials.push_back({m.normal_stiffness[k], m.shear_stiffness[k], m.density[k], m.friction[k], m.normal_strength[k],
                         m.shear_strength[k], m.rolling_stiffness[k], m.rolling_friction[k], m.restitution[k],
                         m.rotation[k] != 0});
  return materials;
}

dem::ContactOptions to_contact_options(const protocol::ContactOptions& m) {
  if (m.geometry != "frozen" && m.geometry != "updated")
    throw engine::RequestError("CONTACT_OPTIONS.geometry", "unknown geometry '" + m.geometry + "'",
                               "known: frozen, updated");
  const auto geometry = m.geometry == "frozen" ? dem::Geometry::frozen : dem::Geometry::updated;
  return {geometry, m.rotations != 0, m.skin};
}

std::vector<dem::Wall> to_walls(const protocol::Walls& m) {
  std::vector<dem::Wall> walls(m.friction.size());
  for (std::size_t k = 0; k < walls.size(); ++k) {
    walls[k].point = to_vec(m.point.row(k));
    walls[k].normal = to_vec(m.normal.row(k));
    walls[k].friction = m.friction[k];
    walls[k].velocity = to_vec(m.velocity.row(k));
  }
  return walls;
}

dem::BlockSetup to_block(protocol::Block&& m) {
  dem::BlockSetup setup;
  setup.vertices = to_field(m.vertices);
  setup.face_ptr = std::move(m.face_ptr.data);
  setup.face_vertices = std::move(m.face_vertices.data);
  setup.mass = m.mass;
  setup.velocity = to_vec(m.velocity.data);
  setup.spin = to_vec(m.spin.data);
  setup.rotation = m.rotation != 0;
  setup.friction = m.friction;
  return setup;
}

protocol::Packed make_packing(protocol::Pack&& m) {
  dem::PackingRequest request;
  request.box.lo = to_vec(m.box_lo.data);
  request.box.hi = to_vec(m.box_hi.data);
  for (int axis = 0; axis < 3; ++axis) request.box.periodic[axis] = m.periodic[axis] != 0;
  request.radius_kind = m.radius_kind;
  request.radius = std::move(m.radius.data);
  request.solid_fraction = m.solid_fraction;
  request.contacts_per_grain = m.contacts_per_grain;
  request.min_contacts = m.min_contacts;
  request.seed = m.seed;
  const dem::Packing packing = dem::make_packing(request);
  protocol::Packed packed;
  packed.position = flat(packing.position);
  packed.radius = packing.radius;
  packed.gap = packing.gap;
  packed.contacts_per_grain = packing.contacts_per_grain;
  packed.solid_fraction = packing.solid_fraction;
  packed.rattlers = packing.rattlers;
  packed.residual_overlap = packing.residual_overlap;
  return packed;
}

/// The engine's bonds as they were made, without weights.
dem::BondNetwork bond_network(const dem::DemEngine& engine) {
  const dem::Grains& grains = engine.grains();
  const dem::Domain domain = engine.domain();
  dem::BondNetwork network;
  network.centres = engine.motion.position;
  network.radii = grains.radius;
  for (std::size_t i = 0; i < grains.size(); ++i) {
    network.density.push_back(grains.material_of(i).density);
    network.locked.push_back(engine.rotates(i) ? 0 : 1);
  }
  for (const dem::Pair& pair : engine.bonds()) {
    const auto i = static_cast<std::size_t>(pair.i), j = static_cast<std::size_t>(pair.j);
    const Vec branch = network.centres[j] + domain.offset(pair.image) - network.centres[i];
    const double distance = engine::norm(branch);
    const dem::ContactSpring spring = dem::contact_spring(grains, i, j, 1.0);
    network.bonds.push_back({pair.i, pair.j, branch / dem::splat(distance), 0.5 * distance + spring.half_difference,
                             0.5 * distance - spring.half_difference, spring.normal, spring.shear});
  }
  return network;
}

void need_bonds(const dem::DemEngine& engine, const char* request) {
  if (engine.bonds().empty())
    throw engine::RequestError(request, "the grains are not bonded", "send BONDS before PREPARE");
  if (!engine.clumps().empty())
    throw engine::RequestError(request, "grains are joined to clumps", "send GRAINS and BONDS without CLUMPS");
}

protocol::Homogenised homogenise(const dem::DemEngine& engine, const protocol::Homogenise& m) {
  need_bonds(engine, "HOMOGENISE");
  dem::HomogeniseOptions options;
  options.threads = engine.threads;
  const dem::Window window{to_vec(m.box_lo.data), to_vec(m.box_hi.data)};
  const dem::Homogenised result = dem::homogenise(bond_network(engine), engine.domain(), window, options);
  protocol::Homogenised reply;
  for (int row = 0; row < 6; ++row)
    for (int column = 0; column < 6; ++column) reply.stiffness[6 * row + column] = result.stiffness(row, column);
  reply.density = result.density;
  reply.residual = result.residual;
  return reply;
}

protocol::FaceOffset measure_face(const dem::DemEngine& engine, protocol::MeasureFace&& m) {
  constexpr std::uint32_t faces = 6;
  need_bonds(engine, "MEASURE_FACE");
  if (m.face >= faces)
    throw engine::RequestError("MEASURE_FACE.face", "there is no face " + std::to_string(m.face), "send 0 to 5");
  const dem::HeldFace face{.axis = static_cast<int>(m.face / 2), .high = m.face % 2 == 1, .place = m.place,
                           .grains = std::move(m.entities.data), .components = m.components};
  const dem::Window window{to_vec(m.box_lo.data), to_vec(m.box_hi.data)};
  const dem::FaceOffset result = dem::face_offset(bond_network(engine), engine.domain(), face, window, {});
  protocol::FaceOffset reply;
  reply.offset = result.offset;
  reply.residual = result.residual;
  return reply;
}

protocol::TriaxialCurve to_message(const std::vector<dem::CurvePoint>& curve, const dem::SampleState& state) {
  protocol::TriaxialCurve m;
  for (const dem::CurvePoint& point : curve) {
    m.axial_strain.data.push_back(point.axial_strain);
    m.volume_strain.data.push_back(point.volume_strain);
    m.axial_stress.data.push_back(point.axial_stress);
    m.lateral_stress.data.insert(m.lateral_stress.data.end(), {point.lateral_stress[0], point.lateral_stress[1]});
    m.broken.data.push_back(point.broken);
    m.contacts_per_grain.data.push_back(point.contacts);
    m.sliding.data.push_back(point.sliding);
  }
  const std::uint64_t points = curve.size();
  for (auto* column : {&m.axial_strain, &m.volume_strain, &m.axial_stress, &m.broken, &m.contacts_per_grain, &m.sliding})
    column->set_shape(std::array<std::uint64_t, 1>{points});
  m.lateral_stress.set_shape(std::array<std::uint64_t, 2>{points, 2});
  m.box = std::vector<double>{state.box[0], state.box[1], state.box[2]};
  m.step = state.step;
  m.steps = state.steps;
  m.unbalanced = state.unbalanced;
  m.work = state.work;
  m.energy_error = state.energy_error;
  m.largest_energy = state.largest_energy;
  return m;
}

std::vector<std::string> capabilities() {
  std::vector<std::string> names{"frozen", "updated", "walls", "block", "sponge", "pack", "homogenise", "measure_face", "clumps",
                                 "triaxial"};
  for (const std::string& field : dem::DemEngine::field_names()) names.push_back("field:" + field);
  return names;
}

void serve(protocol::Server& server) {
  using protocol::Ok;
  dem::DemEngine engine;
  protocol::Service service(engine, "dem", capabilities());
  service.on<protocol::Grains>([&](protocol::Grains&& m) {
    engine.set_grains(to_field(m.position), std::move(m.radius.data), std::move(m.material.data));
    return Ok{};
  });
  service.on<protocol::GrainMaterials>([&](const protocol::GrainMaterials& m) {
    engine.set_materials(to_materials(m));
    return Ok{};
  });
  service.on<protocol::ContactOptions>([&](const protocol::ContactOptions& m) {
    engine.set_contact_options(to_contact_options(m));
    return Ok{};
  });
  service.on<protocol::Bonds>([&](const protocol::Bonds& m) {
    const dem::Bonded made = engine.make_bonds(m.gap);
    protocol::Bonded reply;
    reply.bonds = made.bonds;
    reply.contacts_per_grain = made.contacts_per_grain;
    return reply;
  });
  service.on<protocol::Clumps>([&](protocol::Clumps&& m) {
    const dem::Clumped made = engine.make_clumps({std::move(m.clump_size.data), m.gap, std::move(m.single.data)});
    protocol::Clumped reply;
    reply.clumps = made.clumps;
    reply.grains = made.grains;
    reply.aspect_ratio = made.aspect_ratio;
    return reply;
  });
  service.on<protocol::Walls>([&](const protocol::Walls& m) {
    engine.set_walls(to_walls(m));
    return Ok{};
  });
  service.on<protocol::Block>([&](protocol::Block&& m) {
    engine.set_block(to_block(std::move(m)));
    return Ok{};
  });
  service.on<protocol::Sponge>([&](protocol::Sponge&& m) {
    if (m.row_ptr.empty()) m.row_ptr = std::vector<std::int32_t>{0};
    engine.set_sponge(std::move(m.grains.data), std::move(m.beta.data), m.hats, m.row_ptr.data, m.columns.data,
                      m.values.data);
    return Ok{};
  });
  service.on<protocol::Pack>([&](protocol::Pack&& m) {
    engine.phase = "packing";
    return make_packing(std::move(m));
  });
  service.on<protocol::Homogenise>([&](const protocol::Homogenise& m) {
    engine.phase = "homogenising";
    return homogenise(engine, m);
  });
  service.on<protocol::MeasureFace>([&](protocol::MeasureFace&& m) {
    engine.phase = "measuring a face";
    return measure_face(engine, std::move(m));
  });
  std::optional<dem::TriaxialTest> test;
  service.on<protocol::TriaxialConfine>([&](const protocol::TriaxialConfine& m) {
    engine.phase = "confining a sample";
    test.emplace(engine, dem::Confinement{m.pressure, static_cast<int>(m.axis), m.damping, m.unbalanced, m.max_steps,
                                          m.step_fraction});
    const dem::CurvePoint confined = test->confine();
    return to_message({confined}, test->state());
  });
  service.on<protocol::TriaxialShear>([&](const protocol::TriaxialShear& m) {
    if (!test || !engine.stretched())
      throw engine::RequestError("TRIAXIAL_SHEAR", "the sample is not confined", "send TRIAXIAL_CONFINE first");
    engine.phase = "shearing a sample";
    const auto curve = test->shear({m.axial_strain, m.record_every, m.inertial_number, m.damping});
    return to_message(curve, test->state());
  });
  server.run(service);
}

}  // namespace

int main(int argc, char** argv) {
  return protocol::serve_main(argc, argv, "dem_server", serve);
}
