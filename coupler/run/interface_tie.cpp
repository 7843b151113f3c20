#include "coupler/run/interface_tie.hpp"

#include <algorithm>
#include <cmath>

namespace gabion::coupler {

InterfaceTie::InterfaceTie(const scene::Scene& scene, const Assembly& assembly, EngineLink& dem, EngineLink& continuum)
    : scene_(scene),
      assembly_(assembly),
      dem_(dem),
      rows_(build_rows(scene.coupling.rows, assembly.mesh, assembly.zone, assembly.grains, scene.coupling.reach)) {
  if (scene.coupling.solve == "row_sum") rows_ = explicit_rows(rows_);
  answer_.assign(3 * rows_.slots, 0.0);
  send_tie(dem, rows_.grains, rows_.tied_grains);
  send_tie(continuum, rows_.nodes, rows_.tied_nodes);
}

void InterfaceTie::send_tie(EngineLink& link, const SparseRows& rows, const std::vector<std::int32_t>& tied) {
  protocol::Tie tie;
  tie.mode = rows_.kind == InterfaceRows::Kind::gap ? "gap" : "slave";
  tie.slots = static_cast<std::uint32_t>(rows_.slots);
  tie.tied = tied;
  tie.row_ptr = rows.row_ptr;
  tie.columns = rows.columns;
  tie.values = rows.values;
  link.tell(tie);
}

void InterfaceTie::set_step(double dt, const Inertia& grains, const Inertia& nodes,
                            const std::vector<double>& grain_weights, bool absorb) {
  multipliers_ = std::make_unique<Multipliers>(rows_, grains, nodes, scene_.coupling.solve == "row_sum");
  if (scene_.coupling.sponge.strength == 0.0) return;
  if (absorb)
    send_sponge(dt, grain_weights);
  else if (absorbs_)
    remove_sponge();
  absorbs_ = absorb;
}

void InterfaceTie::remove_sponge() {
  protocol::Sponge none;
  none.hats = static_cast<std::uint32_t>(rows_.slots);
  none.row_ptr = std::vector<std::int32_t>{0};
  dem_.tell(none);
}

/// beta_i = min(1 - w_i, 1 - exp(-eta (1 - w_i)^2 dt)), eta = strength c/L; see docs/theory.md, "Sponge".
void InterfaceTie::send_sponge(double dt, const std::vector<double>& grain_weights) {
  double fastest = 0.0;
  for (int axis = 0; axis < 3; ++axis)
    fastest = std::max(fastest, std::sqrt(p_modulus(assembly_.elasticity.stiffness, axis) / assembly_.elasticity.density));
  const double eta = scene_.coupling.sponge.strength * fastest / assembly_.zone.overlap();
  protocol::Sponge sponge;
  sponge.grains = rows_.hat_grains;
  std::vector<double> beta;
  for (const std::int32_t g : rows_.hat_grains) {
    const double continuum_share = 1.0 - std::min(1.0, grain_weights[g]);
    beta.push_back(std::min(continuum_share, 1.0 - std::exp(-eta * continuum_share * continuum_share * dt)));
  }
  sponge.beta = beta;
  sponge.hats = static_cast<std::uint32_t>(rows_.slots);
  sponge.row_ptr = rows_.hats.row_ptr;
  sponge.columns = rows_.hats.columns;
  sponge.values = rows_.hats.values;
  dem_.tell(sponge);
}

std::span<const double> InterfaceTie::solve(std::span<const double> from_grains, std::span<const double> from_nodes) {
  multipliers_->solve(from_grains, from_nodes, answer_);
  return answer_;
}

}  // namespace gabion::coupler
