#pragma once
// Measured figures of a test, for `gabion test --hard`: one line each on standard output.

#include <cstdio>

namespace gabion {

inline void figure(const char* name, double value) {
  std::printf("figure %s %.6g\n", name, value);
  std::fflush(stdout);
}

}  // namespace gabion
