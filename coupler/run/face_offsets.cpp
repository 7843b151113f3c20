// Where the held faces of the packing are for the ground inside: measured by dem_server, or cached.

#include <cstdio>
#include <stdexcept>

#include "coupler/ground/surface.hpp"
#include "coupler/run/faces.hpp"
#include "coupler/run/preparation.hpp"
#include "protocol/engine/hash.hpp"

namespace gabion::coupler {

namespace {

/// Changes when what a cached file depends on changes in meaning.
constexpr std::uint64_t cache_version = 1;
constexpr double largest_residual = 1e-3;
/// A window that ends farther from the face, in mean diameters, says nothing of it.
constexpr double farthest_window = 3.0;

/// What holds the face first, by the order of the stages; 0 where its normal is never held.
std::uint8_t first_hold(int face, const scene::Scene& scene) {
  const auto normal_held = [&](const scene::Face& condition) -> std::uint8_t {
    const std::uint8_t bits = held_components(face, condition, true);
    return bits & 1 << face / 2 ? bits : std::uint8_t{0};
  };
  if (const std::uint8_t bits = normal_held(scene.faces[face])) return bits;
  for (const scene::Stage& stage : scene.stages)
    for (const auto& [changed, condition] : stage.faces)
      if (changed == face)
        if (const std::uint8_t bits = normal_held(condition)) return bits;
  return 0;
}

std::uint64_t key_of(const protocol::MeasureFace& face, const scene::Scene& scene, const Packing& packing) {
  engine::Hash key;
  key.add(cache_version);
  std::vector<std::byte> bytes;
  protocol::Writer writer(bytes);
  face.encode(writer);
  for (const std::byte b : bytes) key.add(static_cast<std::uint64_t>(b));
  for (const Point& x : packing.position)
    for (const double c : x) key.add(c);
  for (const double r : packing.radius) key.add(r);
  const scene::Material& soil = scene.material(scene.ground.material);
  key.add(packing.gap);
  key.add(soil.shear_stiffness / soil.normal_stiffness);
  const bool rotating = scene.grains.rotations && soil.rotates;
  key.add(rotating ? std::uint64_t{1} : std::uint64_t{2});  // not 0, see obtain_elasticity
  for (int axis = 0; axis < 3; ++axis) {
    key.add(scene.ground.box.lo[axis]);
    key.add(scene.ground.box.hi[axis]);
    key.add(static_cast<std::uint64_t>(scene.ground.periodic[axis]));
  }
  return key.value();
}

[[noreturn]] void refuse(int face, double residual) {
  char text[256];
  std::snprintf(text, sizeof text,
                "faces.%s: where the held grains are for the ground inside could not be measured, the load case has a residual "
                "of %.3g; set mesh.held_faces = plain",
                face_names[face], residual);
  throw std::runtime_error(text);
}

}  // namespace

std::array<double, 6> obtain_face_offsets(const scene::Scene& scene, const Packing& packing, EngineLink* dem, const Cache& cache,
                                          const Log& log) {
  std::array<double, 6> offsets{};
  if (!uses_mesh(scene.model) || scene.mesh.held_faces != "measured") return offsets;
  const Box& box = scene.ground.box;
  const Box window = homogenisation_window(scene, packing);
  const GrainSet grains{.position = packing.position, .radius = packing.radius, .plain_mass = {}};
  const double diameter = packing.mean_diameter();
  bool told = false;
  for (int face = 0; face < 6; ++face) {
    const int axis = face / 2;
    const bool high = face % 2 == 1;
    const std::uint8_t components = scene.ground.periodic[axis] ? std::uint8_t{0} : first_hold(face, scene);
    const double away = high ? box.hi[axis] - window.hi[axis] : window.lo[axis] - box.lo[axis];
    if (components == 0 || away > farthest_window * diameter) continue;
    protocol::MeasureFace request;
    request.face = static_cast<std::uint32_t>(face);
    request.place = high ? box.hi[axis] : box.lo[axis];
    request.entities = grains_at_face(face, box, grains);
    if (request.entities.empty()) continue;
    request.components = components;
    request.box_lo = std::vector<double>(window.lo.begin(), window.lo.end());
    request.box_hi = std::vector<double>(window.hi.begin(), window.hi.end());
    const auto path = cache.file("face", key_of(request, scene, packing));
    std::optional<protocol::FaceOffset> measured = read_cached<protocol::FaceOffset>(path);
    if (!measured) {
      if (!dem) throw protocol::AddressError("the offset of a held face is not in the cache: a dem_server is needed to measure it (--dem)");
      if (!told) tell_bonded_packing(scene, packing, *dem);
      told = true;
      measured = dem->ask<protocol::FaceOffset>(request);
      if (measured->residual > largest_residual) refuse(face, measured->residual);
      write_cached(path, *measured);
    }
    offsets[static_cast<std::size_t>(face)] = measured->offset;
    char text[96];
    std::snprintf(text, sizeof text, "face %s: the grains held there act as a plane %.4g m inside, %.2f mean diameters", face_names[face],
                  measured->offset, measured->offset / diameter);
    log(text);
  }
  return offsets;
}

}  // namespace gabion::coupler
