#include "coupler/run/progress.hpp"

#include <unistd.h>

#include <algorithm>
#include <cstdio>

namespace gabion::coupler {

namespace {
constexpr double terminal_interval = 0.5;  // s
constexpr double file_interval = 10.0;     // s
}  // namespace

Progress::Progress() : terminal_(isatty(STDERR_FILENO) != 0), rated_(Clock::now()) {}

void Progress::show(const std::string& stage, std::uint64_t step, double time, double part, double unbalanced,
                    double energy_error) {
  const Clock::time_point now = Clock::now();
  const bool new_stage = stage != stage_;
  if (new_stage) {
    if (stage_.empty()) rated_step_ = step;  // a run that goes on begins with many steps behind it
    stage_ = stage;
    stage_begin_ = now;
    first_part_ = part;
  }
  if (!new_stage && std::chrono::duration<double>(now - shown_).count() < (terminal_ ? terminal_interval : file_interval)) return;
  const double passed = std::chrono::duration<double>(now - rated_).count();
  if (passed > 0.0 && step > rated_step_) rate_ = static_cast<double>(step - rated_step_) / passed;
  rated_ = shown_ = now;
  rated_step_ = step;
  char left[32] = "";
  if (part > first_part_ && part < 1.0) {
    const double eta = std::chrono::duration<double>(now - stage_begin_).count() * (1.0 - part) / std::max(part - first_part_, 1e-6);
    std::snprintf(left, sizeof left, "  ETA %.0f s", eta);
  }
  std::fprintf(stderr, "%s%-10s t = %.6g s  step %llu  %.0f steps/s%s  unbalanced %.1e  energy error %.1e%s",
               terminal_ ? "\r\033[K" : "", stage.c_str(), time, static_cast<unsigned long long>(step), rate_, left,
               unbalanced, energy_error, terminal_ ? "" : "\n");
  std::fflush(stderr);
  dirty_ = terminal_;
}

void Progress::end_line() {
  if (dirty_) std::fputc('\n', stderr);
  dirty_ = false;
}

}  // namespace gabion::coupler
