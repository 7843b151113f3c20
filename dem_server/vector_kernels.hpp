#pragma once
// Vector steps of the contact kernels. Products and sums are joined here by hand and nowhere else (the
// kernels are compiled with -ffp-contract=off): the loops of one and of several threads must round alike.

#ifdef __FMA__
#include <immintrin.h>
#endif

#include "protocol/engine/vec.hpp"

namespace gabion::dem {

/// a b + c
inline engine::Vec fma(engine::Vec a, engine::Vec b, engine::Vec c) {
#ifdef __FMA__
  return _mm256_fmadd_pd(a, b, c);
#else
  return a * b + c;
#endif
}

/// c - a b
inline engine::Vec fnma(engine::Vec a, engine::Vec b, engine::Vec c) {
#ifdef __FMA__
  return _mm256_fnmadd_pd(a, b, c);
#else
  return c - a * b;
#endif
}

/// a x b; fourth places must be zero.
inline engine::Vec cross_of(engine::Vec a, engine::Vec b) {
  const engine::Vec a_yzx = __builtin_shufflevector(a, a, 1, 2, 0, 3);
  const engine::Vec b_yzx = __builtin_shufflevector(b, b, 1, 2, 0, 3);
  const engine::Vec c = fnma(a_yzx, b, a * b_yzx);
  return __builtin_shufflevector(c, c, 1, 2, 0, 3);
}

/// a.b in all four places; the fourth place must be zero in one of them.
inline engine::Vec dot_all(engine::Vec a, engine::Vec b) {
  engine::Vec m = a * b;
  m += __builtin_shufflevector(m, m, 1, 0, 3, 2);
  return m + __builtin_shufflevector(m, m, 2, 3, 0, 1);
}

/// x, y, z, 0: the fourth place of contact arrays carries other numbers.
inline engine::Vec without_fourth(engine::Vec a) {
  return __builtin_shufflevector(a, engine::Vec{}, 0, 1, 2, 4);
}

}  // namespace gabion::dem
