#include "server/engine/propagation/shared_part.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <utility>
#include <vector>

#include "server/engine/map/contradiction.hpp"
#include "server/engine/map/drift.hpp"
#include "server/engine/map/surroundings.hpp"
#include "server/engine/map/ways.hpp"

namespace isthmus {
namespace {

Eigen::Vector2d position(const Map& map, PatchId id) { return position(map.manifold().pose(id)); }

// Where patches lie, by cells of the distance that is asked for.
class NearbyPlaces {
 public:
  explicit NearbyPlaces(double radius_m) : radius_m_(radius_m) {}
  NearbyPlaces(const Map& map, std::span<const PatchId> patches, double radius_m) : radius_m_(radius_m) {
    for (const PatchId id : patches) add(position(map, id));
  }

  void add(const Eigen::Vector2d& at) { cells_[cell(at)].push_back(at); }

  bool any_near(const Eigen::Vector2d& at) const {
    const auto [x, y] = cell(at);
    for (int i = x - 1; i <= x + 1; ++i) {
      for (int k = y - 1; k <= y + 1; ++k) {
        const auto found = cells_.find({i, k});
        if (found != cells_.end() && std::ranges::any_of(found->second, [&](const Eigen::Vector2d& its) {
              return (its - at).norm() < radius_m_;
            }))
          return true;
      }
    }
    return false;
  }

 private:
  std::pair<int, int> cell(const Eigen::Vector2d& at) const {
    return {static_cast<int>(std::floor(at.x() / radius_m_)),
            static_cast<int>(std::floor(at.y() / radius_m_))};
  }

  double radius_m_;
  std::map<std::pair<int, int>, std::vector<Eigen::Vector2d>> cells_;
};

double own_way_m(const Map& map, std::span<const PatchId> its, std::span<const PatchId> others,
                 const EngineOptions& options) {
  const NearbyPlaces nearby(map, others, options.surroundings.reach_m);
  std::vector<PatchId> alone;
  for (const PatchId id : its)
    if (!nearby.any_near(position(map, id))) alone.push_back(id);
  return way_m(map, alone, options.shared_part);
}

// Pairs across the border, taken evenly over those whose views may meet: as far from what matched as the map
// cannot have bent by so much as would put a wall deep into free space. Farther on a loop may be open.
double border_contradiction(const Map& map, std::span<const PatchId> first, std::span<const PatchId> second,
                            std::span<const PatchId> matched, const EngineOptions& options) {
  const std::vector<double> ways_m = ways_over_relations_m(map, matched);
  const auto way_m = [&](PatchId id) { return ways_m[static_cast<std::size_t>(id.value)]; };
  const auto may_have_bent = [&](PatchId a, PatchId b) {
    const double deep_m = options.contradiction.deep_m;
    return !(systematic_variance(way_m(a) + way_m(b), options.place_candidates).x() < deep_m * deep_m);
  };
  std::vector<std::pair<PatchId, PatchId>> pairs;
  for (const PatchId a : first)
    for (const PatchId b : second)
      if ((position(map, a) - position(map, b)).norm() <
              options.surroundings.reach_m + options.propagation.slack_m &&
          !may_have_bent(a, b))
        pairs.emplace_back(a, b);
  const std::size_t stride =
      std::max<std::size_t>(1, pairs.size() / static_cast<std::size_t>(options.trial.max_pairs));
  MeanContradiction found(options.contradiction);
  for (std::size_t i = 0; i < pairs.size(); i += stride)
    found.add(map.manifold(), pairs[i].first, pairs[i].second);
  return found.mean();
}

}  // namespace

double way_m(const Map& map, std::span<const PatchId> patches, const SharedPartOptions& options) {
  NearbyPlaces apart(options.stride_m);
  std::size_t strides = 0;
  for (const PatchId id : patches) {
    if (apart.any_near(position(map, id))) continue;
    apart.add(position(map, id));
    ++strides;
  }
  return options.stride_m * static_cast<double>(strides);
}

double unmatched_way_m(const Map& map, const RelationGraph& apart, std::span<const PatchId> known,
                       std::span<const PatchId> matched, const EngineOptions& options) {
  const double beside_m = 2 * options.shared_part.stride_m;  // in this place or the next
  const std::set<PatchId> matching(matched.begin(), matched.end());
  const auto matches_beside = [&](PatchId id) {
    const std::vector<PatchId> own_way =
        apart.within_hops(id, options.common.near_hops, says_where_walls_are);
    return std::ranges::any_of(own_way, [&](PatchId other) {
      return matching.contains(other) && (position(map, other) - position(map, id)).norm() < beside_m;
    });
  };
  std::vector<PatchId> unmatched;
  for (const PatchId id : known)
    if (!matches_beside(id)) unmatched.push_back(id);
  return way_m(map, unmatched, options.shared_part);
}

std::vector<PatchId> overlapping(const Map& map, std::span<const PatchId> first,
                                 std::span<const PatchId> second, const EngineOptions& options) {
  std::vector<PatchId> near;
  const auto add_near = [&](std::span<const PatchId> its, std::span<const PatchId> others) {
    const NearbyPlaces nearby(map, others, options.surroundings.reach_m);
    for (const PatchId id : its)
      if (nearby.any_near(position(map, id))) near.push_back(id);
  };
  add_near(first, second);
  add_near(second, first);
  return near;
}

double width_m(const Map& map, std::span<const PatchId> patches) {
  if (patches.size() < 2) return 0;
  Eigen::Vector2d mean = Eigen::Vector2d::Zero();
  for (const PatchId id : patches) mean += position(map, id) / static_cast<double>(patches.size());
  Eigen::Matrix2d scatter = Eigen::Matrix2d::Zero();
  for (const PatchId id : patches) {
    const Eigen::Vector2d off = position(map, id) - mean;
    scatter += off * off.transpose() / static_cast<double>(patches.size());
  }
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d> axes(scatter, Eigen::EigenvaluesOnly);
  return 2 * std::sqrt(std::max(0.0, axes.eigenvalues()(0)));
}

SharedPart shared_part(const Map& map, std::span<const PatchId> island,
                       const std::function<bool(PatchId)>& second, std::span<const PatchId> matched,
                       const EngineOptions& options) {
  std::vector<PatchId> of_first;
  std::vector<PatchId> of_second;
  for (const PatchId id : island)
    if (!map.manifold().patch(id).points.empty()) (second(id) ? of_second : of_first).push_back(id);
  SharedPart shared;
  shared.own_first_m = own_way_m(map, of_first, of_second, options);
  shared.own_second_m = own_way_m(map, of_second, of_first, options);
  shared.border_contradiction = border_contradiction(map, of_first, of_second, matched, options);
  return shared;
}

}  // namespace isthmus
