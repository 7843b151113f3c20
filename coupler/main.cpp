// The coupler: reads a scene, drives the engines, writes the run folder.

#include <CLI/CLI.hpp>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <iostream>
#include <memory>
#include <xmmintrin.h>

#include "coupler/laboratory/laboratory.hpp"
#include "coupler/results/errors.hpp"
#include "coupler/run/checkpoint.hpp"
#include "coupler/run/simulation.hpp"
#include "coupler/scene/read_scene.hpp"

namespace {

using namespace gabion;

/// Exit codes that scripts can rely on; docs/running.md.
constexpr int finished = 0, failed = 1, user_mistake = 2, physics = 3, interrupted_by_user = 130;

/// Set by SIGINT and SIGTERM; the simulation looks at it between two chunks of steps.
volatile std::sig_atomic_t interrupted = 0;
void interrupt(int) { interrupted = 1; }

struct Arguments {
  std::string scene, out, dem, continuum, token_file, resume;
  std::vector<std::string> overrides;
  double io_timeout = std::chrono::duration<double>(coupler::EngineLink::default_patience).count();  // s
  bool check = false, overwrite = false, json = false, laboratory = false;
};

std::string read_token(const std::string& token_file) {
  if (token_file.empty()) {
    const char* token = std::getenv("GABION_TOKEN");
    return token ? token : "";
  }
  std::ifstream in(token_file);
  std::string token;
  if (!std::getline(in, token)) throw protocol::AddressError("--token-file: cannot read " + token_file);
  return token;
}

int run(const Arguments& arguments) {
  const scene::ReadResult read = scene::read_scene(arguments.scene, arguments.overrides);
  for (const scene::SceneProblem& warning : read.warnings) std::cerr << "warning: " << warning.text() << "\n";
  if (arguments.laboratory) coupler::check_laboratory(read.scene);
  const bool grains = coupler::uses_grains(read.scene.model), mesh = coupler::uses_mesh(read.scene.model);
  if (arguments.check) {
    if (arguments.json)
      std::cout << nlohmann::json{{"scene", read.scene.name}, {"hash", read.hash_text}, {"dem", grains}, {"continuum", mesh},
                                  {"zone_to_choose", grains && mesh && read.scene.grains.zone_to_choose},
                                  {"effective", nlohmann::json::parse(read.effective)}}.dump() << "\n";
    else
      std::cout << arguments.scene << ": valid (" << read.hash_text << ")\n";
    return finished;
  }
  if (grains && mesh && read.scene.grains.zone_to_choose)
    throw coupler::ScenarioError("coupling.zone: 'auto' is chosen by gabion run, which gives the coupler a box in its place; gabion zone prints one");
  const auto need = [](bool wanted, const std::string& address, const char* option) {
    if (wanted && address.empty())
      throw protocol::AddressError(std::string(option) + " HOST:PORT is needed for this model: start the engine, it prints its port");
  };
  need(grains, arguments.dem, "--dem");
  need(mesh, arguments.continuum, "--continuum");

  nlohmann::json checkpoint;
  if (!arguments.resume.empty()) checkpoint = coupler::read_checkpoint(arguments.resume, read.hash_text);
  const std::string token = read_token(arguments.token_file);
  if (grains && mesh && arguments.dem == arguments.continuum)
    throw protocol::AddressError("--continuum: the same address as --dem, " + arguments.dem + "; each engine has a port of its own");
  coupler::Activity activity;
  std::unique_ptr<coupler::EngineLink> dem, continuum;
  const std::chrono::milliseconds patience(static_cast<std::int64_t>(1e3 * arguments.io_timeout));
  if (!arguments.dem.empty())
    dem = std::make_unique<coupler::EngineLink>("dem", protocol::parse_address(arguments.dem), token, read.hash_text, activity, patience);
  if (!arguments.continuum.empty() && mesh)
    continuum = std::make_unique<coupler::EngineLink>("continuum", protocol::parse_address(arguments.continuum), token, read.hash_text, activity, patience);

  using Existing = coupler::RunFolder::Existing;
  coupler::RunFolder folder(arguments.out, arguments.overwrite ? Existing::replace : Existing::refuse);
  folder.write_text("scene.effective.json", read.effective);
  if (arguments.laboratory) {
    coupler::run_laboratory(read.scene, folder, *dem, &interrupted);
    dem->say_goodbye();
    return finished;
  }
  auto simulation = std::make_unique<coupler::Simulation>(read.scene, read.hash_text, folder, dem.get(), continuum.get(), activity);
  if (!checkpoint.is_null()) simulation->resume_from(std::move(checkpoint));
  simulation->stop_when(&interrupted);
  try {
    const nlohmann::json summary = simulation->run();
    for (coupler::EngineLink* link : {dem.get(), continuum.get()})
      if (link) link->say_goodbye();
    std::cerr << "finished: " << summary["step"]["count"] << " steps, energy error " << summary["energy"]["balance_error"]
              << ", results in " << arguments.out << "\n";
  } catch (const std::exception& error) {
    folder.log(std::string("stopped: ") + error.what());
    const bool began = simulation->began();
    if (!simulation->last_checkpoint().empty())
      std::cerr << "\nlast checkpoint: " << simulation->last_checkpoint() << "; go on with gabion resume " << arguments.out << " (coupler: --resume)\n";
    simulation.reset();
    if (!began) folder.abandon();  // nothing was computed: the next try finds the folder as this one did
    throw;
  }
  return finished;
}

}  // namespace

int main(int argc, char** argv) {
  _mm_setcsr(_mm_getcsr() | 0x8040);  // denormals are zero, in and out
  std::signal(SIGINT, interrupt);
  std::signal(SIGTERM, interrupt);
  Arguments arguments;
  CLI::App app{"Couples a dem_server and a continuum_server by Lagrange multipliers, and writes the results of a scene."};
  app.add_option("scene", arguments.scene, "scene file (JSON)")->required();
  app.add_option("--set", arguments.overrides, "override a key: key.path=value; may be repeated")->allow_extra_args(false);
  app.add_option("--out", arguments.out, "run folder")->default_val("run");
  app.add_option("--dem", arguments.dem, "HOST:PORT of the dem_server");
  app.add_option("--continuum", arguments.continuum, "HOST:PORT of the continuum_server");
  app.add_option("--token-file", arguments.token_file, "file with the run's token (default: environment variable GABION_TOKEN)");
  app.add_option("--io-timeout", arguments.io_timeout, "seconds that an engine may be silent within a step or a request")
      ->check(CLI::Range(0.1, 1e6));
  app.add_option("--resume", arguments.resume, "run folder, or checkpoint in it, to go on from; results go to --out");
  app.add_flag("--check", arguments.check, "only check the scene");
  app.add_flag("--json", arguments.json, "with --check: print what the scene needs as JSON");
  app.add_flag("--laboratory", arguments.laboratory, "do the scene's laboratory tests in place of its stages");
  app.add_flag("--overwrite", arguments.overwrite, "replace an earlier run in the run folder");
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    const int code = app.exit(error);
    return code == 0 ? finished : user_mistake;
  }
  try {
    return run(arguments);
  } catch (const scene::SceneError& error) {
    std::cerr << "\n" << error.what() << "\n";
    return user_mistake;
  } catch (const protocol::AddressError& error) {
    std::cerr << "\ncoupler: " << error.what() << "\n";
    return user_mistake;
  } catch (const coupler::ScenarioError& error) {
    std::cerr << "\n" << arguments.scene << ": " << error.what() << "\n";
    return user_mistake;
  } catch (const coupler::RunFolderError& error) {
    std::cerr << "\ncoupler: " << error.what() << "\n";
    return user_mistake;
  } catch (const protocol::RemoteError& error) {
    std::cerr << "\ncoupler: " << error.what() << "\n";
    if (error.code == "value" || error.code == "token" || error.code == "version") return user_mistake;
    return error.code == "physics" ? physics : failed;
  } catch (const protocol::VersionMismatch& error) {
    std::cerr << "\ncoupler: " << error.what() << "; use programs of the same release\n";
    return user_mistake;
  } catch (const coupler::Interrupted& error) {
    std::cerr << "\n" << arguments.scene << ": " << error.what() << "\n";
    return interrupted_by_user;
  } catch (const coupler::RunFailed& error) {
    std::cerr << "\n" << arguments.scene << ": " << error.what() << "\n";
    return physics;
  } catch (const std::exception& error) {
    std::cerr << "\ncoupler: " << error.what() << "\n";
    return failed;
  }
}
