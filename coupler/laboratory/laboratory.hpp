#pragma once
// Tests on the ground of a scene as a periodic sample: its elasticity, then triaxial tests at the scene's confinements.

#include <csignal>

#include "coupler/results/run_folder.hpp"
#include "coupler/run/engine_link.hpp"
#include "coupler/scene/scene.hpp"

namespace gabion::coupler {

/// Throws ScenarioError where the scene cannot be tested, with what to change.
void check_laboratory(const scene::Scene& scene);

/// Writes laboratory.json (sample, stiffness, how each test went) and one curve-<pressure>Pa.csv a confinement.
/// Throws Interrupted once the flag is set, between two parts of a test.
void run_laboratory(const scene::Scene& scene, RunFolder& folder, EngineLink& dem, const volatile std::sig_atomic_t* stop);

}  // namespace gabion::coupler
