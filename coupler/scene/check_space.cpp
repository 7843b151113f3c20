#include <algorithm>
#include <bit>
#include <cmath>

#include "coupler/scene/checks.hpp"
#include "coupler/scene/geometry.hpp"
#include "coupler/scene/origin.hpp"
#include "coupler/scene/units.hpp"

namespace gabion::scene {
namespace {

constexpr const char* axis_names[] = {"x", "y", "z"};
constexpr double rounding = 1e-9;  // relative slack of comparisons between given lengths

std::string metres(double length) {
  constexpr double digits = 1e6;  // shown to a micrometre
  return format_quantity(std::round(length * digits) / digits, "m");
}

std::string item(const std::string& list, std::size_t index) {
  return list + "[" + std::to_string(index) + "]";
}

double extent(const Box& box, int axis) {
  return box.hi[axis] - box.lo[axis];
}

double smallest_extent(const Box& box) {
  return std::min({extent(box, 0), extent(box, 1), extent(box, 2)});
}

/// The lower corner must be below the upper one in each direction.
bool ordered(Checker& check, const Box& box, const std::string& path) {
  for (int axis = 0; axis < 3; ++axis) {
    if (extent(box, axis) > tolerance(box)) continue;
    check.error(path, std::string("a lower corner below the upper one in ") + axis_names[axis],
                "write [[xmin, ymin, zmin], [xmax, ymax, zmax]]");
    return false;
  }
  return true;
}

/// Far from the origin numbers are coarse; a ground whose sides they change is another ground.
bool too_far(Checker& check) {
  constexpr double finest = 1e-6;  // step between coordinates over the ground's smallest side
  const Scene& scene = check.scene;
  for (int axis = 0; axis < 3; ++axis) {
    const double step = coordinate_step(scene.origin[axis]);
    if (step == 0.0 || step <= finest * smallest_extent(scene.ground.box)) continue;
    check.error("ground.box", std::string("coordinates nearer to 0 in ") + axis_names[axis],
                "so far away they are told apart to " + format_quantity(step, "m") + " only; move the scene");
    return true;
  }
  return false;
}

void check_fills(Checker& check) {
  const Scene& scene = check.scene;
  for (std::size_t i = 0; i < scene.fills.size(); ++i) {
    const std::string path = item("fills", i) + ".box";
    const Box& fill = scene.fills[i].box;
    if (!ordered(check, fill, path)) continue;
    bool meets = true;
    for (int axis = 0; axis < 3; ++axis)
      meets = meets && fill.lo[axis] < scene.ground.box.hi[axis] && fill.hi[axis] > scene.ground.box.lo[axis];
    if (!meets) check.error(path, "a box that meets the ground", "compare with ground.box");
  }
}

void check_radius(Checker& check) {
  const Grains& grains = check.scene.grains;
  const bool lattice = is_lattice(grains);
  const auto& r = grains.radius;
  if (lattice && r.size() != 1) {
    check.error("grains.radius", "one radius for the lattice '" + grains.packing + "'",
                "write \"radius\": \"0.05 m\", or use packing = random for a distribution");
    return;
  }
  if (grains.radius_kind == "uniform" && r.front() > r.back())
    check.error("grains.radius.uniform", "the smaller radius first", "swap the two values");
  if (grains.radius_kind == "sieve") {
    bool rising = r.size() >= 4 && r[1] == 0.0 && r.back() == 1.0;
    for (std::size_t i = 0; i + 3 < r.size(); i += 2) rising = rising && r[i] < r[i + 2] && r[i + 1] <= r[i + 3];
    if (!rising)
      return check.error("grains.radius.sieve", "at least two sieves, radii rising, shares passing from 0 to 1",
                         "write the grain-size curve, as in [[\"5 cm\", 0], [\"8 cm\", 0.6], [\"10 cm\", 1]]");
  }
  double largest = 0.0;
  const std::size_t stride = grains.radius_kind == "sieve" ? 2 : 1;
  for (std::size_t i = 0; i < r.size(); i += stride) largest = std::max(largest, r[i]);
  // a random packing needs room for two of the largest grains side by side
  if ((lattice ? 2 : 4) * largest > smallest_extent(check.scene.ground.box))
    check.error(
        "grains.radius",
        "grains that fit into the ground, whose smallest side is " + metres(smallest_extent(check.scene.ground.box)),
        "make the grains smaller or the ground larger");
}

/// The lattice is fitted to the first periodic direction; the others must then hold whole cells too.
void check_lattice(Checker& check) {
  const Scene& scene = check.scene;
  if (!is_lattice(scene.grains) || scene.grains.radius.size() != 1) return;
  constexpr double largest_change = 0.01;  // of the radius by the fit
  double cell = cell_over_radius(scene.grains.packing) * scene.grains.radius[0];
  bool fitted = false;
  for (int axis = 0; axis < 3; ++axis) {
    if (!scene.ground.periodic[axis]) continue;
    const double cells = extent(scene.ground.box, axis) / cell, whole = std::max(1.0, std::round(cells));
    const double misfit = std::abs(cells / whole - 1);
    if (misfit > (fitted ? rounding : largest_change))
      check.error("ground.box",
                  std::string("a whole number of lattice cells along the periodic direction ") + axis_names[axis] +
                      ", such as " + metres(whole * cell) + " (" + std::to_string(std::lround(whole)) + " cells of " +
                      metres(cell) + ")",
                  "change the ground or grains.radius");
    if (!fitted) cell *= cells / whole;
    fitted = true;
  }
}

/// Returns false when the zone makes no sense, so that nothing more is said about it.
bool check_zone(Checker& check) {
  const Scene& scene = check.scene;
  if (check.coupled() && scene.grains.zone_to_choose) {
    if (std::none_of(scene.stages.begin(), scene.stages.end(), [](const Stage& stage) { return stage.damping == 0.0; }))
      check.error(check.zone_path(), "a box: auto needs a stage without damping, in which the load acts", "give the zone's two corners");
    return false;  // nothing to look at yet
  }
  const std::string path = check.zone_path();
  if (scene.grains.zone) {
    if (!ordered(check, *scene.grains.zone, path)) return false;
    const double slack = tolerance(scene.ground.box);
    if (!contains(scene.ground.box, scene.grains.zone->lo, slack) ||
        !contains(scene.ground.box, scene.grains.zone->hi, slack)) {
      check.error(path, "a box inside the ground",
                  "compare with ground.box; a face of the zone may lie on one of the ground");
      return false;
    }
  }
  if (!check.coupled()) return true;
  for (int face = 0; face < 6; ++face)
    if (is_interface(scene, face)) return true;
  check.error(path, "a box with a face inside the ground, where grains and mesh are tied",
              "make the zone smaller than the ground, or use model = dem");
  return false;
}

void check_overlap(Checker& check) {
  const Scene& scene = check.scene;
  if (scene.model != Model::bridging) return;
  const double overlap = scene.coupling.overlap, element = scene.mesh.size;
  const std::string path = check.coupling_path("overlap");
  // elements of at least 2.5 diameters make 2 elements the 5 diameters that a packing's moduli need as well
  if (overlap < element * (1 - rounding))
    check.error(path, "at least 1 element, " + metres(element), "make the overlap wider or mesh.size smaller");
  else if (overlap < 2 * element * (1 - rounding) && !scene.block)  // impacts were measured with one
    check.warn(path, "at least 2 elements, " + metres(2 * element),
               "with one the moduli of a sample are 6 % off, and waves of 6 elements return with 14 % of their height");
  for (int axis = 0; axis < 3; ++axis) {
    const int faces = is_interface(scene, 2 * axis) + is_interface(scene, 2 * axis + 1);
    const double side = extent(*scene.grains.zone, axis);
    if (faces * overlap < side * (1 - rounding)) continue;
    check.error(path,
                std::string("an overlap that leaves grains alone inside the zone, below ") + metres(side / faces) +
                    " along " + axis_names[axis],
                "make the overlap narrower or the zone larger");
    break;
  }
}

/// The mesh has the ground's stiffness everywhere: a fill belongs where grains stand alone.
void check_fills_and_mesh(Checker& check) {
  const Scene& scene = check.scene;
  if (scene.model == Model::dem) return;
  Box alone = scene.ground.box;
  if (scene.model == Model::continuum) alone.hi = alone.lo;
  if (check.coupled())
    for (int face = 0; face < 6; ++face) {
      if (!is_interface(scene, face)) continue;
      const double inward = scene.model == Model::bridging ? scene.coupling.overlap : 0.0;
      face_coordinate(alone, face) = face_coordinate(*scene.grains.zone, face) + (face % 2 == 0 ? inward : -inward);
    }
  for (std::size_t i = 0; i < scene.fills.size(); ++i) {
    bool reaches = false;
    for (int axis = 0; axis < 3; ++axis) {
      const double slack = tolerance(scene.ground.box), lo = std::max(scene.fills[i].box.lo[axis], scene.ground.box.lo[axis]),
                   hi = std::min(scene.fills[i].box.hi[axis], scene.ground.box.hi[axis]);
      reaches = reaches || lo < alone.lo[axis] - slack || hi > alone.hi[axis] + slack;
    }
    if (reaches && check.has_grains() && scene.material(scene.fills[i].material).clump_size > 1)
      check.error(item("fills", i) + ".box", "a fill of clumps inside the part where grains stand alone",
                  "clumps cannot be tied or share their place with the mesh: make the zone larger or the fill smaller");
    else if (reaches)
      check.warn(item("fills", i) + ".box", "a fill inside the part where grains stand alone",
                 "the mesh has the stiffness of ground.material everywhere: make the zone larger or the fill smaller");
  }
}

void check_elements(Checker& check) {
  const Scene& scene = check.scene;
  const double h = scene.mesh.size;
  if (h > smallest_extent(scene.ground.box) * (1 + rounding))
    check.error("mesh.size", "at most the smallest side of the ground, " + metres(smallest_extent(scene.ground.box)),
                "make the elements smaller");
  constexpr double least_diameters = 2.5;
  const double least = least_diameters * mean_diameter(scene.grains);
  if (check.coupled() && h < least * (1 - rounding))
    check.error("mesh.size", "at least 2.5 mean grain diameters, " + metres(least),
                "make the elements larger or the grains smaller: finer meshes see the single grains");
}

void check_rates(Checker& check) {
  const auto& rates = check.scene.mesh.rates;
  if (!rates || rates->largest == 0) return;
  if (!std::has_single_bit(static_cast<unsigned>(rates->largest)))
    check.error("mesh.rates.largest", "a power of two: 2, 4, 8, 16 or 32", "a finer rate must take part in every step of a coarser one");
}

void check_probes(Checker& check) {
  const auto& probes = check.scene.probes;
  for (std::size_t i = 0; i < probes.size(); ++i) {
    if (!contains(check.scene.ground.box, probes[i].at, tolerance(check.scene.ground.box)))
      check.error(item("probes", i) + ".at", "a point of the ground", "compare with ground.box");
    for (std::size_t j = 0; j < i; ++j)
      if (probes[j].name == probes[i].name)
        check.error(item("probes", i) + ".name", "a name that no other probe has", "rename one of the two");
  }
}

void check_block_place(Checker& check) {
  const Scene& scene = check.scene;
  if (!scene.block || !check.has_grains()) return;
  const Block& block = *scene.block;
  const Box& ground = scene.ground.box;
  const Box& target = check.coupled() && scene.grains.zone ? *scene.grains.zone : ground;
  const double top = ground.hi[2];
  for (int axis = 0; axis < 2; ++axis)
    if (block.position[axis] < target.lo[axis] || block.position[axis] > target.hi[axis]) {
      check.error("block.position",
                  std::string("a place above the grains, ") + axis_names[axis] + " from " + metres(target.lo[axis]) +
                      " to " + metres(target.hi[axis]),
                  "the block acts on grains only");
      break;
    }
  if (check.coupled() && is_interface(scene, 5))
    check.error(check.zone_path(), "a zone that reaches the top of the ground, where the block hits",
                "raise the zone to " + metres(top));
  const double least = top + depth_below_centre(block);
  if (!block.touching && block.position[2] < least - tolerance(ground))
    check.error("block.position",
                "a height of the centre of at least " + metres(least) + ", so that the block is not in the ground",
                "leave out the third value: the block then begins in touch with the ground");
}

void check_wave(Checker& check) {
  const Scene& scene = check.scene;
  if (!scene.wave) return;
  const Wave& wave = *scene.wave;
  if (wave.centre < scene.ground.box.lo[wave.axis] || wave.centre > scene.ground.box.hi[wave.axis])
    check.error("initial.wave.centre",
                std::string("a place inside the ground, ") + axis_names[wave.axis] + " from " +
                    metres(scene.ground.box.lo[wave.axis]) + " to " + metres(scene.ground.box.hi[wave.axis]),
                "compare with ground.box and initial.wave.axis");
  const double shortest = 4 * mean_diameter(scene.grains);
  if (check.has_grains() && wave.wavelength <= shortest)
    check.warn("initial.wave.wavelength", "more than 4 mean grain diameters, " + metres(shortest),
               "shorter waves feel the single grains");
  constexpr double shortest_elements = 3.14159265358979323846;
  if (check.has_mesh() && wave.wavelength < shortest_elements * scene.mesh.size)
    check.warn("initial.wave.wavelength", "at least pi elements, " + metres(shortest_elements * scene.mesh.size),
               "shorter waves cannot enter the mesh");
}

}  // namespace

void check_space(Checker& check) {
  const Scene& scene = check.scene;
  if (too_far(check) || !ordered(check, scene.ground.box, "ground.box")) return;
  check_fills(check);
  check_probes(check);
  check_wave(check);
  const bool has_radius = !scene.grains.radius.empty(), has_size = scene.mesh.size > 0.0;
  const bool measures = check.has_grains() || scene.mesh.stiffness != "material";
  if (measures && !has_radius)
    check.error(
        "grains", "the grains' radius, such as {\"radius\": {\"uniform\": [\"0.06 m\", \"0.12 m\"]}}",
        check.has_grains() ? "every model but continuum has grains" : "without grains write mesh.stiffness = material");
  if (check.has_mesh() && !has_size)
    check.error("mesh", "the element size, such as {\"size\": \"0.5 m\"}", "every model but dem has a mesh");
  if (has_radius) check_radius(check);
  if (has_radius) check_lattice(check);
  const bool sound_zone = check_zone(check);
  const bool to_choose = check.coupled() && scene.grains.zone_to_choose;
  if (check.has_mesh() && has_size && !to_choose) check_elements(check);
  check_rates(check);
  if (sound_zone && has_size && has_radius) check_overlap(check);
  if (sound_zone) check_fills_and_mesh(check);
  if (sound_zone) check_block_place(check);
}

}  // namespace gabion::scene
