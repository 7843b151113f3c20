#include "dem_server/pair_buffer.hpp"

#include "dem_server/vector_kernels.hpp"

namespace gabion::dem {

void PairBuffer::connect(const std::vector<std::int32_t>& start, const std::vector<std::int32_t>& second, bool couples) {
  const std::size_t grains = start.size() - 1;
  start_ = start;
  second_ = second;
  force.assign(second.size(), Vec{});
  moment.assign(second.size(), Vec{});
  couple.assign(couples ? second.size() : 0, Vec{});
  incoming_start_.assign(grains + 1, 0);
  for (std::size_t i = 0; i < grains; ++i)
    for (std::int32_t c = start[i]; c < start[i + 1]; ++c)
      if (second[c] != static_cast<std::int32_t>(i)) ++incoming_start_[second[c] + 1];
  for (std::size_t i = 0; i < grains; ++i) incoming_start_[i + 1] += incoming_start_[i];
  incoming_.resize(incoming_start_[grains]);
  std::vector<std::int32_t> next(incoming_start_.begin(), incoming_start_.end() - 1);
  for (std::size_t i = 0; i < grains; ++i)
    for (std::int32_t c = start[i]; c < start[i + 1]; ++c)
      if (second[c] != static_cast<std::int32_t>(i)) incoming_[next[second[c]]++] = c;
}

void PairBuffer::gather(std::size_t first, std::size_t last, bool rotating, VecField& grain_force,
                        VecField& grain_torque, int threads) const {
  const auto run = !rotating        ? &PairBuffer::gather_parts<false, false>
                   : couple.empty() ? &PairBuffer::gather_parts<true, false>
                                    : &PairBuffer::gather_parts<true, true>;
  (this->*run)(first, last, grain_force, grain_torque, threads);
}

template <bool rotating, bool couples>
void PairBuffer::gather_parts(std::size_t first, std::size_t last, VecField& grain_force, VecField& grain_torque,
                              int threads) const {
#pragma omp parallel for schedule(static) num_threads(threads) if (threads > 1)
  for (std::size_t g = first; g < last; ++g) {
    Vec f = grain_force[g];
    Vec t = rotating ? grain_torque[g] : Vec{};
    // pairs that name g second have a lower first grain: all of them come before its own
    for (std::int32_t k = incoming_start_[g]; k < incoming_start_[g + 1]; ++k) {
      const std::int32_t c = incoming_[k];
      Vec pair_force = force[c];
      pair_force[3] = 0.0;
      f -= pair_force;
      if (!rotating) continue;
      Vec m = moment[c];
      const Vec arm = splat(m[3]);
      m[3] = 0.0;
      t = fma(arm, m, t);
      if constexpr (couples) t -= couple[c];
    }
    for (std::int32_t c = start_[g]; c < start_[g + 1]; ++c) {
      Vec pair_force = force[c];
      const Vec arm_i = splat(pair_force[3]);
      pair_force[3] = 0.0;
      f += pair_force;
      const bool itself = second_[c] == static_cast<std::int32_t>(g);
      if (itself) f -= pair_force;
      if (!rotating) continue;
      Vec m = moment[c];
      const Vec arm_j = splat(m[3]);
      m[3] = 0.0;
      t = fma(arm_i, m, t);
      if constexpr (couples) t += couple[c];
      if (itself) t = fma(arm_j, m, t);
      if constexpr (couples)
        if (itself) t -= couple[c];
    }
    grain_force[g] = f;
    if (rotating) grain_torque[g] = t;
  }
}

}  // namespace gabion::dem
