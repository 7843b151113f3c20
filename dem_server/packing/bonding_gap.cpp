#include "dem_server/packing/bonding_gap.hpp"

#include <algorithm>
#include <cmath>

namespace gabion::dem {

namespace {

struct Candidate {
  double gap;  ///< over the sum of radii; negative for overlaps
  std::int32_t i, j;
};

std::vector<Candidate> sorted_candidates(const VecField& centres, std::span<const double> radii, const Domain& domain,
                                         double largest_gap) {
  double largest_radius = 0.0;
  for (const double r : radii) largest_radius = std::max(largest_radius, r);
  std::vector<Candidate> candidates;
  for (const Pair& pair : find_pairs(centres, radii, 2.0 * largest_gap * largest_radius, domain)) {
    const Vec d = centres[pair.j] + domain.offset(pair.image) - centres[pair.i];
    const double gap = norm(d) / (radii[pair.i] + radii[pair.j]) - 1.0;
    if (gap <= largest_gap) candidates.push_back({gap, pair.i, pair.j});
  }
  std::sort(candidates.begin(), candidates.end(), [](const Candidate& a, const Candidate& b) {
    return a.gap != b.gap ? a.gap < b.gap : (a.i != b.i ? a.i < b.i : a.j < b.j);
  });
  return candidates;
}

/// 1 for grains away from flat faces; all of them where there is no such grain.
std::vector<std::uint8_t> grains_that_count(const VecField& centres, std::span<const double> radii,
                                            const Domain& domain) {
  double largest = 0.0;
  for (const double r : radii) largest = std::max(largest, r);
  std::vector<std::uint8_t> counts(centres.size(), 1);
  for (std::size_t g = 0; g < centres.size(); ++g)
    for (int a = 0; a < 3; ++a)
      if (!domain.periodic[a] &&
          (centres[g][a] < domain.lo[a] + 2.0 * largest || centres[g][a] > domain.hi[a] - 2.0 * largest))
        counts[g] = 0;
  if (std::find(counts.begin(), counts.end(), 1) == counts.end()) counts.assign(centres.size(), 1);
  return counts;
}

/// The network of the first `count` candidates, without its rattlers.
class Network {
 public:
  Network(std::size_t grains, std::span<const Candidate> bonds, unsigned min_contacts)
      : kept(grains, 1), degree_(grains, 0), start_(grains + 1, 0) {
    for (const Candidate& bond : bonds) {
      ++start_[bond.i + 1];
      ++start_[bond.j + 1];
    }
    for (std::size_t g = 0; g < grains; ++g) {
      degree_[g] = start_[g + 1];
      start_[g + 1] += start_[g];
    }
    partners_.resize(2 * bonds.size());
    std::vector<std::size_t> next(start_.begin(), start_.end() - 1);
    for (const Candidate& bond : bonds) {
      partners_[next[bond.i]++] = bond.j;
      partners_[next[bond.j]++] = bond.i;
    }
    for (std::size_t g = 0; g < grains; ++g)
      if (degree_[g] < min_contacts) remove_with_followers(g, min_contacts);
  }

  double contacts_per_grain(const std::vector<std::uint8_t>& counts) const {
    std::size_t grains = 0, contacts = 0;
    for (std::size_t g = 0; g < kept.size(); ++g)
      if (kept[g] && counts[g]) {
        ++grains;
        contacts += degree_[g];
      }
    return grains > 0 ? static_cast<double>(contacts) / static_cast<double>(grains) : 0.0;
  }

  void keep_largest_part() {
    std::vector<std::int32_t> part(kept.size(), -1);
    std::vector<std::size_t> sizes;
    for (std::size_t g = 0; g < kept.size(); ++g)
      if (kept[g] && part[g] < 0) sizes.push_back(flood(g, static_cast<std::int32_t>(sizes.size()), part));
    if (sizes.size() < 2) return;
    const auto largest = std::max_element(sizes.begin(), sizes.end()) - sizes.begin();
    for (std::size_t g = 0; g < kept.size(); ++g)
      if (part[g] != largest) kept[g] = 0;
  }

  std::vector<std::uint8_t> kept;

 private:
  void remove_with_followers(std::size_t grain, unsigned min_contacts) {
    std::vector<std::size_t> doomed;
    if (kept[grain]) doomed.push_back(grain);
    kept[grain] = 0;
    while (!doomed.empty()) {
      const std::size_t g = doomed.back();
      doomed.pop_back();
      for (std::size_t k = start_[g]; k < start_[g + 1]; ++k) {
        const std::size_t p = static_cast<std::size_t>(partners_[k]);
        if (!kept[p] || --degree_[p] >= min_contacts) continue;
        kept[p] = 0;
        doomed.push_back(p);
      }
    }
  }

  std::size_t flood(std::size_t seed, std::int32_t label, std::vector<std::int32_t>& part) const {
    std::vector<std::size_t> front{seed};
    part[seed] = label;
    std::size_t size = 0;
    while (!front.empty()) {
      const std::size_t g = front.back();
      front.pop_back();
      ++size;
      for (std::size_t k = start_[g]; k < start_[g + 1]; ++k) {
        const std::size_t p = static_cast<std::size_t>(partners_[k]);
        if (!kept[p] || part[p] >= 0) continue;
        part[p] = label;
        front.push_back(p);
      }
    }
    return size;
  }

  std::vector<std::size_t> degree_;  ///< bonds with kept grains
  std::vector<std::size_t> start_;
  std::vector<std::int32_t> partners_;
};

}  // namespace

BondingGap find_bonding_gap(const VecField& centres, std::span<const double> radii, const Domain& domain,
                            double contacts_per_grain, unsigned min_contacts) {
  constexpr double first_gap = 0.05, last_gap = 0.5;  // 12 and more neighbours lie within the last
  const std::vector<std::uint8_t> counts = grains_that_count(centres, radii, domain);
  for (double largest_gap = first_gap;; largest_gap *= 2.0) {
    const std::vector<Candidate> candidates = sorted_candidates(centres, radii, domain, largest_gap);
    const auto contacts_of = [&](std::size_t count) {
      return Network(centres.size(), std::span(candidates).first(count), min_contacts).contacts_per_grain(counts);
    };
    if (contacts_of(candidates.size()) < contacts_per_grain && largest_gap < last_gap) continue;

    std::size_t low = 0;  // contacts below the target, or the overlapping pairs
    while (low < candidates.size() && candidates[low].gap <= 0.0) ++low;
    std::size_t high = candidates.size();
    if (contacts_of(low) >= contacts_per_grain) high = low;
    while (high - low > 1) {
      const std::size_t middle = low + (high - low) / 2;
      (contacts_of(middle) < contacts_per_grain ? low : high) = middle;
    }
    const bool lower_is_nearer = contacts_per_grain - contacts_of(low) < contacts_of(high) - contacts_per_grain;
    const std::size_t count = lower_is_nearer ? low : high;

    Network network(centres.size(), std::span(candidates).first(count), min_contacts);
    if (min_contacts > 0) network.keep_largest_part();
    BondingGap result;
    // Half-way to the next pair, so that round-off in another place cannot change the network
    const double last = count > 0 ? std::max(candidates[count - 1].gap, 0.0) : 0.0;
    if (count > 0 && candidates[count - 1].gap > 0.0)
      result.gap = count < candidates.size() ? 0.5 * (last + candidates[count].gap) : last;
    result.contacts_per_grain = network.contacts_per_grain(counts);
    result.kept = std::move(network.kept);
    return result;
  }
}

}  // namespace gabion::dem
