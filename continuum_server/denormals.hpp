#pragma once
// Quiet fields ahead of a wave are full of denormals, which cost a hundred times a normal number.

#if defined(__x86_64__)
#include <xmmintrin.h>
#endif

namespace gabion::continuum {

/// Denormal results and operands become zero on the calling thread.
inline void flush_denormals() {
#if defined(__x86_64__)
  constexpr unsigned flush_and_zero = 0x8040;  // FTZ and DAZ bits of MXCSR
  _mm_setcsr(_mm_getcsr() | flush_and_zero);
#endif
}

}  // namespace gabion::continuum
