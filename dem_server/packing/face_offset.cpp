#include "dem_server/packing/face_offset.hpp"

#include <cmath>

#include "protocol/engine/engine.hpp"

namespace gabion::dem {
namespace {

constexpr std::size_t least_grains = 8;

void check(const BondNetwork& network, const HeldFace& face) {
  const auto refuse = [](const char* what, const char* advice) { throw engine::RequestError("face", what, advice); };
  if (face.grains.empty()) refuse("no grain is held at the face", "name the grains that the run will hold there");
  if (!(face.components & 1 << face.axis)) refuse("its normal is not held", "only a face that is held has an offset");
  for (const std::int32_t g : face.grains)
    if (g < 0 || static_cast<std::size_t>(g) >= network.size())
      refuse("a grain that does not exist is held", "indices count from 0");
}

/// Grains within the held layer of this one of the packing's own flat ends.
bool at_this_end(const BondNetwork& network, const HeldFace& face, double layer, std::size_t grain) {
  const double depth = face.high ? face.place - network.centres[grain][face.axis] : network.centres[grain][face.axis] - face.place;
  return depth < layer;
}

/// Held along every flat end of the packing but the two across the axis.
std::vector<std::uint8_t> held_beside(const BondNetwork& network, Domain domain, int axis, double layer) {
  domain.periodic[axis] = true;
  return held_grains(network, domain, layer);
}

/// Least-squares line through the grains in the window: displacement at the face, m, and slope, under a unit strain.
std::pair<double, double> line_from(const HeldFace& face, const BondNetwork& network, const Cutter& cutter,
                                    const GrainMotion& motion) {
  double count = 0, x = 0, u = 0, xx = 0, xu = 0;
  for (std::size_t g = 0; g < network.size(); ++g) {
    const Vec centre = cutter.wrapped(network.centres[g]);
    if (!cutter.contains(centre)) continue;
    const double s = centre[face.axis] - face.place, d = s + motion[2 * g][face.axis];
    count += 1, x += s, u += d, xx += s * s, xu += s * d;
  }
  if (count < static_cast<double>(least_grains))
    throw engine::RequestError("window", "only " + std::to_string(static_cast<int>(count)) + " grains lie in the window",
                               "enlarge the window or move it into the packing");
  const double slope = (count * xu - x * u) / (count * xx - x * x);
  return {(u - slope * x) / count, slope};
}

}  // namespace

FaceOffset face_offset(const BondNetwork& network, const Domain& domain, const HeldFace& face, const Window& window,
                       const HomogeniseOptions& options) {
  check(network, face);
  // The other ends are held as for the stiffness. This one is not, but by the grains that the run will hold.
  std::vector<std::uint8_t> fixed = held_grains(network, domain, options.held_layer);
  const double layer = options.held_layer * 2.0 * network.mean_radius();
  const std::vector<std::uint8_t> beside = held_beside(network, domain, face.axis, options.held_layer);
  for (std::size_t g = 0; g < fixed.size(); ++g)
    if (at_this_end(network, face, layer, g)) fixed[g] = beside[g];
  VecField beyond(network.size(), Vec{});
  for (const std::int32_t g : face.grains) {
    const bool elsewhere = fixed[g] != 0;  // along an edge of the packing: held there too, at the affine displacement
    fixed[g] = static_cast<std::uint8_t>(fixed[g] | face.components);
    if (!elsewhere) beyond[g][face.axis] = face.place - network.centres[g][face.axis];
  }
  const Equilibrium equilibrium(network, std::move(fixed), std::move(beyond));
  GrainMotion motion;
  const SolveOutcome outcome = equilibrium.solve(unit_strain(face.axis), options.limits, motion);
  const auto [at_face, slope] = line_from(face, network, Cutter(window, domain), motion);
  // the line has the face's own displacement, 0, where x - x_face = -at_face/slope
  const double outward = face.high ? 1.0 : -1.0;
  return {outward * at_face / slope, outcome.residual, outcome.converged};
}

}  // namespace gabion::dem
