#include "dem_server/clump_grouping.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <tuple>

namespace gabion::dem {
namespace {

using Image = std::array<std::int8_t, 3>;

struct Neighbour {
  std::int32_t grain;
  Image image;
};

struct Member {
  std::int32_t grain;
  Image image;
};

using Clump = std::vector<Member>;

Image sum_of(const Image& a, const Image& b) {
  return {static_cast<std::int8_t>(a[0] + b[0]), static_cast<std::int8_t>(a[1] + b[1]),
          static_cast<std::int8_t>(a[2] + b[2])};
}

Image opposite(const Image& a) {
  return sum_of({},
                {static_cast<std::int8_t>(-a[0]), static_cast<std::int8_t>(-a[1]), static_cast<std::int8_t>(-a[2])});
}

class Grouper {
 public:
  Grouper(const Grains& grains, const VecField& position, const Domain& domain, const ClumpRequest& request)
      : grains_(grains),
        x_(position),
        domain_(domain),
        request_(request),
        clump_of_(grains.size(), none),
        near_(grains.size()) {
    wanted_.resize(grains.size());
    for (std::size_t i = 0; i < wanted_.size(); ++i) wanted_[i] = request.sizes[grains.material[i]];
    for (const std::int32_t g : request.single) wanted_[g] = 1;
    connect();
    sort_seeds();
  }

  ClumpGrouping run() {
    for (const std::int32_t seed : seeds_)
      if (clump_of_[seed] == none) grow(seed);
    for (const std::int32_t seed : seeds_)
      if (clumps_[clump_of_[seed]].size() == 1) join(seed);
    ClumpGrouping result;
    for (const Clump& clump : clumps_) {
      if (clump.size() < 2) continue;
      for (const Member& m : clump) {
        result.grain.push_back(m.grain);
        result.image.push_back(m.image);
      }
      result.start.push_back(static_cast<std::int32_t>(result.grain.size()));
    }
    return result;
  }

 private:
  static constexpr std::int32_t none = -1;

  void connect() {
    double largest = 0.0;
    for (const double r : grains_.radius) largest = std::max(largest, r);
    // touching pairs are exact in no packing: as for bonds
    constexpr double slack = 1e-9;
    const double reach = request_.gap + slack;
    for (const Pair& p : find_pairs(x_, grains_.radius, 2.0 * reach * largest, domain_)) {
      if (p.i == p.j || wanted_[p.i] < 2 || wanted_[p.j] < 2 || grains_.material[p.i] != grains_.material[p.j])
        continue;
      const double apart = (1.0 + reach) * (grains_.radius[p.i] + grains_.radius[p.j]);
      if (norm(x_[p.j] - x_[p.i] + domain_.offset(p.image)) > apart) continue;
      near_[p.i].push_back({p.j, p.image});
      near_[p.j].push_back({p.i, opposite(p.image)});
    }
  }

  void sort_seeds() {
    for (std::int32_t i = 0; i < static_cast<std::int32_t>(wanted_.size()); ++i)
      if (wanted_[i] > 1) seeds_.push_back(i);
    std::sort(seeds_.begin(), seeds_.end(), [&](std::int32_t a, std::int32_t b) {
      return std::tuple(x_[a][2], x_[a][1], x_[a][0]) < std::tuple(x_[b][2], x_[b][1], x_[b][0]);
    });
    rank_.assign(wanted_.size(), none);
    for (std::size_t k = 0; k < seeds_.size(); ++k) rank_[seeds_[k]] = static_cast<std::int32_t>(k);
  }

  Vec place(const Member& m) const { return x_[m.grain] + domain_.offset(m.image); }

  Vec centre(const Clump& clump) const {
    Vec moment{};
    double volume = 0.0;
    for (const Member& m : clump) {
      const double r = grains_.radius[m.grain], cube = r * r * r;
      moment += splat(cube) * place(m);
      volume += cube;
    }
    return moment / splat(volume);
  }

  void grow(std::int32_t seed) {
    Clump clump{{seed, {}}};
    const auto number = static_cast<std::int32_t>(clumps_.size());
    clump_of_[seed] = number;
    while (clump.size() < static_cast<std::size_t>(wanted_[seed])) {
      const Vec middle = centre(clump);
      Member best{none, {}};
      std::tuple<double, std::int32_t, Image> least;
      for (const Member& m : clump)
        for (const Neighbour& n : near_[m.grain]) {
          if (clump_of_[n.grain] != none) continue;
          const Member candidate{n.grain, sum_of(m.image, n.image)};
          const std::tuple key(norm(place(candidate) - middle), rank_[n.grain], candidate.image);
          if (best.grain != none && !(key < least)) continue;
          best = candidate;
          least = key;
        }
      if (best.grain == none) break;
      clump_of_[best.grain] = number;
      clump.push_back(best);
    }
    clumps_.push_back(std::move(clump));
  }

  /// A sphere that was left alone goes to the smallest clump that it touches.
  void join(std::int32_t alone) {
    Member best{none, {}};
    std::int32_t host = none;
    std::tuple<std::size_t, double, std::int32_t, Image> least;
    for (const Neighbour& n : near_[alone]) {
      const std::int32_t number = clump_of_[n.grain];
      const Clump& clump = clumps_[number];
      if (number == clump_of_[alone] || clump.size() < 2) continue;
      const auto touched =
          std::find_if(clump.begin(), clump.end(), [&](const Member& m) { return m.grain == n.grain; });
      const Member candidate{alone, sum_of(touched->image, opposite(n.image))};
      const std::tuple key(clump.size(), norm(place(candidate) - centre(clump)), number, candidate.image);
      if (host != none && !(key < least)) continue;
      best = candidate;
      host = number;
      least = key;
    }
    if (host == none) return;
    clumps_[clump_of_[alone]].clear();
    clump_of_[alone] = host;
    clumps_[host].push_back(best);
  }

  const Grains& grains_;
  const VecField& x_;
  const Domain& domain_;
  const ClumpRequest& request_;
  std::vector<std::int32_t> wanted_, clump_of_, seeds_, rank_;
  std::vector<std::vector<Neighbour>> near_;
  std::vector<Clump> clumps_;
};

}  // namespace

ClumpGrouping group_clumps(const Grains& grains, const VecField& position, const Domain& domain,
                           const ClumpRequest& request) {
  return Grouper(grains, position, domain, request).run();
}

Clumped count_clumps(const ClumpGrouping& grouping, const Grains& grains, const VecField& position,
                     const Domain& domain) {
  using Eigen::Matrix3d, Eigen::Vector3d;
  Clumped total{grouping.size(), grouping.grain.size(), 0.0};
  for (std::size_t b = 0; b < grouping.size(); ++b) {
    std::vector<Vector3d> places;
    std::vector<double> radii;
    Vector3d middle = Vector3d::Zero();
    double volume = 0.0;
    for (std::int32_t k = grouping.start[b]; k < grouping.start[b + 1]; ++k) {
      const Vec x = position[grouping.grain[k]] + domain.offset(grouping.image[k]);
      places.emplace_back(x[0], x[1], x[2]);
      radii.push_back(grains.radius[grouping.grain[k]]);
      const double cube = std::pow(radii.back(), 3);
      middle += cube * places.back();
      volume += cube;
    }
    middle /= volume;
    Matrix3d spread = Matrix3d::Zero();
    for (std::size_t k = 0; k < places.size(); ++k)
      spread += std::pow(radii[k], 3) * (places[k] - middle) * (places[k] - middle).transpose();
    const Matrix3d axes = Eigen::SelfAdjointEigenSolver<Matrix3d>(spread).eigenvectors();
    double longest = 0.0, narrowest = INFINITY;
    for (int axis = 0; axis < 3; ++axis) {
      double low = INFINITY, high = -INFINITY;
      for (std::size_t k = 0; k < places.size(); ++k) {
        const double along = axes.col(axis).dot(places[k] - middle);
        low = std::min(low, along - radii[k]);
        high = std::max(high, along + radii[k]);
      }
      longest = std::max(longest, high - low);
      narrowest = std::min(narrowest, high - low);
    }
    total.aspect_ratio += longest / narrowest / static_cast<double>(grouping.size());
  }
  return total;
}

}  // namespace gabion::dem
