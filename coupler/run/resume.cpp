// Simulation: checkpoints and what follows from them. A checkpoint is taken between two chunks of steps. A run that goes
// on prepares as any other, applies what the scene's earlier stages did to the faces, and then takes the engines' own
// states: from there it takes the same steps, bit for bit, as the run that was not broken off.

#include "coupler/run/checkpoint.hpp"
#include "coupler/run/simulation.hpp"

namespace gabion::coupler {

namespace {

nlohmann::json state_of(EngineLink* link) {
  if (!link) return nullptr;
  return nlohmann::json::binary(std::move(link->ask<protocol::State>(protocol::Checkpoint{}).blob.data));
}

void give_state(EngineLink* link, const nlohmann::json& saved) {
  if (!link) return;
  protocol::Restore restore;
  const std::vector<std::uint8_t>& bytes = saved.get_binary();
  restore.blob = bytes;
  link->tell(restore);
}

nlohmann::json to_json(const PlacedBlock& block) {
  return {{"vertices", block.vertices}, {"face_ptr", block.face_ptr}, {"face_vertices", block.face_vertices},
          {"surface_level", block.surface_level}, {"lowest", block.lowest}};
}

PlacedBlock block_of(const nlohmann::json& saved) {
  PlacedBlock block;
  saved.at("vertices").get_to(block.vertices);
  saved.at("face_ptr").get_to(block.face_ptr);
  saved.at("face_vertices").get_to(block.face_vertices);
  saved.at("surface_level").get_to(block.surface_level);
  saved.at("lowest").get_to(block.lowest);
  return block;
}

}  // namespace

bool Simulation::checkpoint_due() const {
  const std::chrono::duration<double> passed = std::chrono::steady_clock::now() - checkpointed_;
  return scene_.run.checkpoint_every > 0.0 && passed.count() >= scene_.run.checkpoint_every;
}

void Simulation::save_checkpoint() {
  activity_.is("writing a checkpoint");
  nlohmann::json state{
      {"scene_hash", scene_hash_}, {"scene", resumed_.is_null() ? scene_.name : resumed_.at("scene").get<std::string>()},
      {"step", stepper_->step()}, {"time", stepper_->time()}, {"dt", dt_},
      {"stage", at_.stage}, {"taken", at_.taken}, {"most", at_.most}, {"least", at_.least}, {"unbalanced", at_.unbalanced},
      {"next_output", next_output_}, {"largest_rotation", largest_rotation_}, {"largest_damage", largest_tied_damage_}, {"stable_dem", stable_dem_}, {"stable_continuum", stable_continuum_},
      {"zone_watch", zone_watch_ ? zone_watch_->memory() : nlohmann::json()}, {"steps_to_look", steps_to_look_},
      {"stages", stages_}, {"warnings", warnings_}, {"period", rates_->period()}, {"largest_rate", rates_->largest()},
      {"rates_used", rates_used_}, {"element_steps", element_steps_}, {"grain_steps", grain_steps_}, {"recorder", recorder_->memory()}, {"faces", faces_->dead_loads()},
      {"block", block_ ? to_json(*block_) : nlohmann::json()}, {"dem", state_of(dem_)}, {"continuum", state_of(continuum_)}};
  write_checkpoint(folder_.file(checkpoint_name), state);
  checkpointed_ = std::chrono::steady_clock::now();
  last_checkpoint_ = "step " + std::to_string(stepper_->step()) + " in " + folder_.file(checkpoint_name).string();
  log_("checkpoint: step " + std::to_string(stepper_->step()));
}

std::size_t Simulation::restore_checkpoint() {
  const nlohmann::json& saved = resumed_;
  saved.at("stages").get_to(stages_);
  saved.at("warnings").get_to(warnings_);
  at_ = {.stage = saved.at("stage"), .taken = saved.at("taken"), .most = saved.at("most"), .least = saved.at("least"),
         .unbalanced = saved.at("unbalanced")};
  for (std::size_t s = 0; s <= at_.stage; ++s) apply_faces(s, s == 0 ? 0.0 : stages_.at(s - 1).at("time").get<double>());
  faces_->tell_dead_loads(saved.at("faces"));
  if (!saved.at("block").is_null()) {
    block_ = block_of(saved.at("block"));
    tell_block();
  }
  saved.at("next_output").get_to(next_output_);
  saved.at("largest_damage").get_to(largest_tied_damage_);
  saved.at("largest_rotation").get_to(largest_rotation_);
  saved.at("steps_to_look").get_to(steps_to_look_);
  if (zone_watch_) zone_watch_->remember(saved.at("zone_watch"));
  saved.at("stable_dem").get_to(stable_dem_);
  saved.at("stable_continuum").get_to(stable_continuum_);
  rates_->resume(saved.at("period"), saved.at("largest_rate"));
  saved.at("element_steps").get_to(element_steps_);
  saved.at("grain_steps").get_to(grain_steps_);
  rates_used_ = saved.at("rates_used");
  place_probes();
  set_step(saved.at("dt"));
  give_state(dem_, saved.at("dem"));
  give_state(continuum_, saved.at("continuum"));
  stepper_->resume(saved.at("step"), saved.at("time"));
  recorder_->remember(saved.at("recorder"));
  const std::string& stage = scene_.stages.at(at_.stage).name;
  log_("resumed: stage " + stage + ", step " + std::to_string(stepper_->step()));
  recorder_->state(stage, stepper_->step(), stepper_->time(), dt_, dem_, continuum_, tie_ ? &*tie_ : nullptr);
  return at_.stage;
}

}  // namespace gabion::coupler
