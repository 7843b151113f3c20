// continuum_server: the continuum engine behind the protocol.

#include <algorithm>

#include "continuum_server/continuum_engine.hpp"
#include "protocol/messages.hpp"
#include "protocol/session/server.hpp"

namespace {

using namespace gabion;

continuum::Mesh to_mesh(protocol::Mesh&& message) {
  const std::size_t count = message.elements.rows();
  for (const std::size_t rows : {message.wrap.rows(), message.material.rows()})
    if (rows != count)
      throw engine::RequestError("MESH.elements",
                                 std::to_string(count) + " elements, but " + std::to_string(message.wrap.rows()) +
                                     " rows of wrap and " + std::to_string(message.material.rows()) + " materials",
                                 "send one of each per element");
  continuum::Mesh mesh;
  mesh.nodes.reserve(message.nodes.rows());
  for (std::size_t n = 0; n < message.nodes.rows(); ++n) {
    const auto x = message.nodes.row(n);
    mesh.nodes.push_back(engine::vec(x[0], x[1], x[2]));
  }
  mesh.elements.resize(count);
  mesh.wrap.resize(count);
  for (std::size_t e = 0; e < count; ++e) {
    std::ranges::copy(message.elements.row(e), mesh.elements[e].begin());
    std::ranges::copy(message.wrap.row(e), mesh.wrap[e].begin());
  }
  mesh.material = std::move(message.material.data);
  return mesh;
}

std::vector<continuum::SolidMaterial> to_materials(const protocol::SolidMaterials& message) {
  const std::size_t count = message.density.rows();
  if (message.stiffness.rows() != count)
    throw engine::RequestError(
        "SOLID_MATERIALS.density",
        std::to_string(count) + " densities for " + std::to_string(message.stiffness.rows()) + " stiffness matrices",
        "send one of each");
  std::vector<continuum::SolidMaterial> materials(count);
  for (std::size_t k = 0; k < count; ++k) {
    std::ranges::copy(message.stiffness.row(k), materials[k].stiffness.begin());
    materials[k].density = message.density[k];
    continuum::check(materials[k], k);
  }
  return materials;
}

std::vector<std::string> capabilities() {
  std::vector<std::string> names;
  for (const std::string& field : continuum::ContinuumEngine::field_names()) names.push_back("field:" + field);
  names.push_back("rates");
  return names;
}

void serve(protocol::Server& server) {
  continuum::ContinuumEngine engine;
  protocol::Service service(engine, "continuum", capabilities());
  service.on<protocol::Mesh>([&](protocol::Mesh&& message) {
    engine.set_mesh(to_mesh(std::move(message)));
    return protocol::Ok{};
  });
  service.on<protocol::SolidMaterials>([&](const protocol::SolidMaterials& message) {
    engine.set_materials(to_materials(message));
    return protocol::Ok{};
  });
  service.on<protocol::Rates>([&](const protocol::Rates& message) {
    engine.set_rates(message.rate.data);
    return protocol::Ok{};
  });
  server.run(service);
}

}  // namespace

int main(int argc, char** argv) {
  return protocol::serve_main(argc, argv, "continuum_server", serve);
}
