#include "protocol/session/server.hpp"

#include <omp.h>
#include <xmmintrin.h>

#include <CLI/CLI.hpp>
#include <cstdlib>
#include <fstream>
#include <iostream>

namespace gabion::protocol {

namespace {

constexpr int largest_thread_count = 256;

constexpr int wrong_usage = 2;
constexpr int failure = 1;
constexpr int most_refusals = 100;  ///< clients turned away before the server gives up

/// Denormal numbers, in which a wave's tail ends, take a hundred times longer: flush them to zero
/// (bit 15) and read them as zero (bit 6), on every thread that computes.
void flush_denormals(int threads) {
  omp_set_dynamic(0);
  omp_set_num_threads(threads);
#pragma omp parallel num_threads(threads)
  _mm_setcsr(_mm_getcsr() | 0x8040u);
}

struct UsageError : std::runtime_error {
  using std::runtime_error::runtime_error;
};

std::string read_token(const std::string& file) {
  std::string token;
  if (!file.empty()) {
    std::ifstream in(file);
    if (!in) throw UsageError("cannot read the token file " + file);
    std::getline(in, token);
  } else if (const char* given = std::getenv("GABION_TOKEN")) {
    token = given;
  }
  if (token.empty())
    throw UsageError("no token: set the environment variable GABION_TOKEN or give --token-file, as the client must");
  return token;
}

Duration seconds(double value) {
  return std::chrono::duration_cast<Duration>(std::chrono::duration<double>(value));
}

}  // namespace

void Server::run(Service& service) {
  engine::Engine& engine = service.engine();
  engine.threads = settings_.threads;
  engine.motion.threads = settings_.threads;
  Listener listener(settings_.listen);
  const Address address = listener.address();
  std::cout << "LISTENING " << address.host << ' ' << address.port << std::endl;
  const Clock::time_point deadline = Clock::now() + settings_.accept_timeout;
  for (int refusals = 0; refusals < most_refusals; ++refusals) {
    const Duration left = std::max(Duration::zero(), deadline - Clock::now());
    Connection connection = listener.accept(left, "coupler", settings_.connection);
    if (service.serve(connection, settings_.token, settings_.session) == Service::Outcome::finished) return;
  }
  throw Timeout("coupler", "waiting for a connection", 0, "too many clients without the token");
}

int serve_main(int argc, char** argv, const std::string& name, const std::function<void(Server&)>& body) {
  ServerSettings settings;
  std::string listen = "127.0.0.1:0", token_file;
  double accept_timeout = 60.0, io_timeout = 30.0, idle_timeout = 600.0;
  long spin = settings.connection.spin.count();
  settings.threads = 1;
  settings.session.software = name + " " GABION_VERSION;

  CLI::App app("Gabion engine; serves one client and ends");
  app.name(name);
  app.set_version_flag("--version", settings.session.software);
  app.add_option("--listen", listen, "host:port to listen on; port 0 takes a free one")->capture_default_str();
  app.add_option("--threads", settings.threads, "threads to compute with")
      ->check(CLI::Range(1, largest_thread_count))
      ->capture_default_str();
  app.add_option("--token-file", token_file, "file with the token; else the environment variable GABION_TOKEN");
  app.add_option("--accept-timeout", accept_timeout, "s to wait for a client")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  app.add_option("--io-timeout", io_timeout, "s to wait for the answer to a step, for a client's next heartbeat, and for what is sent to be taken")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  app.add_option("--idle-timeout", idle_timeout, "s to wait for the next request of a client that sends no heartbeats")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  app.add_option("--spin", spin, "microseconds to look for an answer before sleeping")
      ->check(CLI::NonNegativeNumber)
      ->capture_default_str();
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? 0 : wrong_usage;
  }
  try {
    settings.listen = parse_address(listen);
    settings.token = read_token(token_file);
    settings.accept_timeout = seconds(accept_timeout);
    settings.session.exchange_timeout = settings.connection.send_timeout = seconds(io_timeout);
    settings.session.idle_timeout = seconds(idle_timeout);
    settings.connection.spin = std::chrono::microseconds(spin);
    flush_denormals(settings.threads);
    Server server(settings);
    body(server);
    return 0;
  } catch (const AddressError& error) {
    std::cerr << name << ": " << error.what() << '\n';
    return wrong_usage;
  } catch (const UsageError& error) {
    std::cerr << name << ": " << error.what() << '\n';
    return wrong_usage;
  } catch (const std::exception& error) {
    std::cerr << name << ": " << error.what() << '\n';
    return failure;
  }
}

}  // namespace gabion::protocol
