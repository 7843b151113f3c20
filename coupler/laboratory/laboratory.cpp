#include "coupler/laboratory/laboratory.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "coupler/run/preparation.hpp"
#include "coupler/run/progress.hpp"
#include "coupler/run/simulation.hpp"

namespace gabion::coupler {
namespace {

using nlohmann::json;

constexpr int axis = 2;
/// Local damping while confining: what remains is quasi-static.
constexpr double confining_damping = 0.7;
/// Step over the stable one; contacts come and go while a part of a test is under way.
constexpr double step_fraction = 0.8;
/// Points of a curve before and after peak_strain.
constexpr double points = 100.0;
/// Parts in which a test is asked for, between which there is progress to tell; they hold whole numbers of points.
constexpr int parts_to_peak = 10, parts_beyond = 50;

const std::vector<std::string> columns{"axial_strain", "volume_strain", "axial_stress [Pa]", "lateral_stress_1 [Pa]", "lateral_stress_2 [Pa]",
                                       "broken_bonds", "contacts_per_grain", "sliding"};

/// The worst of what the parts of one test report.
struct Report {
  protocol::TriaxialCurve last;
  double energy_error = 0.0;  ///< over the largest energy

  void add(const protocol::TriaxialCurve& curve) {
    last = curve;
    if (curve.largest_energy > 0.0) energy_error = std::max(energy_error, std::fabs(curve.energy_error) / curve.largest_energy);
  }
};

std::string number(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%g", value);
  return text;
}

void write(History& file, const protocol::TriaxialCurve& curve) {
  for (std::size_t k = 0; k < curve.axial_strain.size(); ++k)
    file.append({curve.axial_strain[k], curve.volume_strain[k], curve.axial_stress[k], curve.lateral_stress[2 * k],
                                   curve.lateral_stress[2 * k + 1], curve.broken[k], curve.contacts_per_grain[k], curve.sliding[k]});
}

json told(const protocol::TriaxialCurve& curve) {
  return {{"box", curve.box.data}, {"steps", curve.steps}, {"step", curve.step}, {"unbalanced", curve.unbalanced}, {"work", curve.work}};
}

/// One test on a fresh sample.
class Test {
 public:
  Test(const scene::Scene& scene, EngineLink& dem, const volatile std::sig_atomic_t* stop) : scene_(scene), lab_(*scene.laboratory), dem_(dem), stop_(stop) {}

  json run(double pressure, History& file) {
    protocol::TriaxialConfine confine;
    confine.pressure = pressure;
    confine.axis = axis;
    confine.damping = confining_damping;
    confine.unbalanced = lab_.unbalanced;
    confine.max_steps = lab_.max_steps;
    confine.step_fraction = step_fraction;
    name_ = number(pressure / 1e3) + " kPa";
    const auto confined = dem_.ask<protocol::TriaxialCurve>(confine);
    take(confined, file);
    const double peak = std::min(lab_.peak_strain, lab_.axial_strain);
    shear(0.0, peak, parts_to_peak, lab_.peak_inertial_number, file);
    if (peak < lab_.axial_strain) shear(peak, lab_.axial_strain, parts_beyond, lab_.inertial_number, file);
    progress_.end_line();
    const double volume = confined.box[0] * confined.box[1] * confined.box[2];
    double before = 1.0;
    for (int a = 0; a < 3; ++a) before *= scene_.ground.box.hi[a] - scene_.ground.box.lo[a];
    return {{"confinement", pressure},
            {"confined", {{"volume_strain", 1.0 - volume / before}, {"broken_bonds", confined.broken[0]}, {"contacts_per_grain", confined.contacts_per_grain[0]},
                          {"unbalanced", confined.unbalanced}, {"steps", confined.steps}}},
            {"end", told(report_.last)},
            {"energy_error", report_.energy_error}};
  }

 private:
  void shear(double from, double to, int parts, double inertial_number, History& file) {
    protocol::TriaxialShear request;
    request.record_every = (to - from) / points;
    request.inertial_number = inertial_number;
    request.damping = lab_.damping;
    for (int part = 1; part <= parts; ++part) {
      if (stop_ && *stop_) throw Interrupted("stopped in the test at " + name_ + "; curves up to here are complete");
      request.axial_strain = from + (to - from) * part / parts;
      take(dem_.ask<protocol::TriaxialCurve>(request), file);
    }
  }

  void take(const protocol::TriaxialCurve& curve, History& file) {
    report_.add(curve);
    write(file, curve);
    const double strain = curve.axial_strain.data.back();
    progress_.show(name_, curve.steps, static_cast<double>(curve.steps) * curve.step, strain / lab_.axial_strain, curve.unbalanced, report_.energy_error);
  }

  const scene::Scene& scene_;
  const scene::Laboratory& lab_;
  EngineLink& dem_;
  const volatile std::sig_atomic_t* stop_;
  std::string name_;
  Report report_;
  Progress progress_;
};

}  // namespace

void check_laboratory(const scene::Scene& scene) {
  const auto refuse = [](const std::string& text) { throw ScenarioError(text); };
  if (!scene.laboratory) refuse("laboratory: missing; say which tests are wanted, as in {\"confinements\": [\"20 kPa\", \"50 kPa\"]}");
  if (scene.model != scene::Model::dem) refuse("model: '" + scene::to_string(scene.model) + "', but laboratory tests are made on grains; use dem");
  for (const bool periodic : scene.ground.periodic)
    if (!periodic) refuse("ground.periodic: laboratory tests need [\"x\", \"y\", \"z\"]");
  if (scene.grains.geometry != "updated") refuse("grains.geometry: 'frozen', but contacts of a laboratory test must be able to break; use updated");
  if (scene.gravity != scene::Point{}) refuse("gravity: leave it out in laboratory tests");
  if (scene.block) refuse("block: leave it out in laboratory tests");
}

void run_laboratory(const scene::Scene& scene, RunFolder& folder, EngineLink& dem, const volatile std::sig_atomic_t* stop) {
  const Cache cache;
  const Log log = [&](const std::string& line) { folder.log(line); };
  const Packing packing = obtain_packing(scene, &dem, cache, log);
  scene::Scene measured = scene;
  measured.mesh.stiffness = "measured";
  const Elasticity elasticity = obtain_elasticity(measured, packing, &dem, cache, log);
  const IsotropicFit fit = isotropic_fit(elasticity.stiffness);
  json result{{"sample",
               {{"grains", packing.position.size()}, {"rattlers_removed", packing.rattlers}, {"solid_fraction", packing.solid_fraction},
                {"contacts_per_grain", packing.contacts_per_grain}, {"bonding_gap", packing.gap}, {"seed", scene.grains.seed},
                {"mean_diameter", packing.mean_diameter()}}},
              {"elasticity", {{"young", fit.young}, {"poisson", fit.poisson}, {"misfit", fit.misfit}, {"density", elasticity.density}}},
              {"tests", json::array()}};
  for (const auto& row : elasticity.stiffness) result["elasticity"]["stiffness"].push_back(row);
  folder.write_json("laboratory.json", result);
  for (const double pressure : scene.laboratory->confinements) {
    Assembly sample = assemble(scene, packing, elasticity);
    configure_dem(scene, sample, dem, log);
    const std::string curve = "curve-" + number(pressure) + "Pa.csv";
    History file = folder.history(curve, columns);
    Test test(scene, dem, stop);
    json done = test.run(pressure, file);
    file.flush();
    done["curve"] = curve;
    result["tests"].push_back(done);
    folder.write_json("laboratory.json", result);
    log("test at " + number(pressure) + " Pa: " + done.dump());
  }
}

}  // namespace gabion::coupler
