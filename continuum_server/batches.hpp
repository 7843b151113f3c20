#pragma once
// Elements in batches of eight: by tier (rates.hpp), those that touch the interface first, then by material, then by number.

#include <algorithm>
#include <cstddef>
#include <tuple>
#include <vector>

#include "continuum_server/distorted.hpp"

namespace gabion::continuum {

inline void copy_lane(const BrickBatch& from, int lane, BrickBatch& to, int place) {
  for (int axis = 0; axis < 3; ++axis) to.inverse[axis][place] = from.inverse[axis][lane];
  to.scale[place] = from.scale[lane];
  to.material = from.material;
}
inline void silence_lane(BrickBatch& batch, int lane) {
  batch.scale[lane] = 0.0;
}
inline std::int32_t material_key(const BrickBatch& batch) {
  return batch.material;
}

inline void copy_lane(const DistortedBatch& from, int lane, DistortedBatch& to, int place) {
  for (int entry = 0; entry < packed_size; ++entry) to.stiffness[entry][place] = from.stiffness[entry][lane];
}
inline void silence_lane(DistortedBatch& batch, int lane) {
  for (Lanes& entry : batch.stiffness) entry[lane] = 0.0;
}
/// Stiffness holds the material: any two may share a batch.
inline std::int32_t material_key(const DistortedBatch&) {
  return 0;
}

constexpr std::int32_t no_element = -1;

template <class Batch>
struct Batches {
  std::vector<Batch> batch;
  std::vector<std::int32_t> element;  ///< of each lane, no_element where there is none
  std::size_t interface_end = 0;      ///< batches before this one touch the interface
  std::vector<std::uint8_t> tier;     ///< of each batch

  std::size_t elements() const {
    return element.size() - static_cast<std::size_t>(std::count(element.begin(), element.end(), no_element));
  }

  /// Appends an element, in a batch of its own; call arrange() after the last one.
  void add(std::int32_t number, const Batch& lane_0) {
    batch.push_back(lane_0);
    element.insert(element.end(), lane_count, no_element);
    element[element.size() - lane_count] = number;
  }

  /// Rebuilds the batches so that elements of the finest tier come first, and among them those with a node below reach.
  /// tier_of_element: empty where all are of tier 0. Elements with a node below reach must be of tier 0.
  void arrange(std::size_t reach, const std::vector<std::uint8_t>& tier_of_element) {
    struct Lane {
      std::uint8_t tier;
      bool interior;
      std::int32_t material, element;
      std::size_t from;
      auto key() const { return std::tuple(tier, interior, material, element); }
      auto batch() const { return std::tuple(tier, interior, material); }
    };
    std::vector<Lane> lanes;
    for (std::size_t slot = 0; slot < element.size(); ++slot) {
      if (element[slot] == no_element) continue;
      const Batch& old = batch[slot / lane_count];
      bool interior = true;
      for (int corner = 0; corner < 8; ++corner)
        if (static_cast<std::size_t>(old.node[corner][slot % lane_count]) < reach) interior = false;
      const std::uint8_t own = tier_of_element.empty() ? 0 : tier_of_element[static_cast<std::size_t>(element[slot])];
      lanes.push_back({own, interior, material_key(old), element[slot], slot});
    }
    std::sort(lanes.begin(), lanes.end(), [](const Lane& a, const Lane& b) { return a.key() < b.key(); });

    Batches arranged;
    int place = lane_count;
    const Lane* last = nullptr;
    for (const Lane& lane : lanes) {
      if (!last || place == lane_count || last->batch() != lane.batch()) {
        arranged.start_batch();
        arranged.tier.push_back(lane.tier);
        place = 0;
      }
      arranged.put(batch[lane.from / lane_count], static_cast<int>(lane.from % lane_count), lane.element, place++);
      if (!lane.interior) arranged.interface_end = arranged.batch.size();
      last = &lane;
    }
    *this = std::move(arranged);
  }

 private:
  void start_batch() {
    batch.emplace_back();
    element.insert(element.end(), lane_count, no_element);
  }

  /// Copies a lane; the first one also fills the rest of the batch, without stiffness.
  void put(const Batch& from, int lane, std::int32_t number, int place) {
    Batch& to = batch.back();
    for (int p = place; p < (place == 0 ? lane_count : place + 1); ++p) {
      for (int corner = 0; corner < 8; ++corner) to.node[corner][p] = from.node[corner][lane];
      copy_lane(from, lane, to, p);
      if (p > place) silence_lane(to, p);
    }
    element[element.size() - lane_count + place] = number;
  }
};

}  // namespace gabion::continuum
