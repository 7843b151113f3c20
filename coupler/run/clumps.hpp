#pragma once
// Clumps of a scene: which grains dem_server may join, and what came of it.

#include <optional>

#include "coupler/run/assembly.hpp"
#include "protocol/messages.hpp"

namespace gabion::coupler {

/// The request, or none when every grain stays single. Grains that a face holds or absorbs with in some stage are named
/// single, so that a clump never has a member with a velocity of its own.
std::optional<protocol::Clumps> clump_request(const scene::Scene& scene, const Assembly& assembly);

/// For the log: how many clumps, and how many grains of their materials stayed single.
std::string describe_clumps(const protocol::Clumped& clumped, const scene::Scene& scene, const Assembly& assembly);

}  // namespace gabion::coupler
