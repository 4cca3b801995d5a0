#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <limits>
#include <span>
#include <utility>
#include <vector>

namespace isthmus {

/// How far a search goes: everywhere; or, where there is a goal, to `share` of what the way to it takes and
/// `more_m` on top.
struct SearchReach {
  std::int32_t goal = -1;
  float share = 1;
  float more_m = 0;
};

/// Points of a surface, by number, and which are beside which. Never changed.
class PointGraph {
 public:
  PointGraph() = default;
  /// `pairs`: each way round, in any order; the same one may be there again.
  PointGraph(std::vector<Eigen::Vector2d> points_m,
             const std::vector<std::pair<std::int32_t, std::int32_t>>& pairs);

  std::size_t size() const { return points_m_.size(); }
  const Eigen::Vector2d& point_m(std::int32_t number) const { return points_m_[at(number)]; }
  std::span<const std::int32_t> beside(std::int32_t number) const {
    return {beside_.data() + first_[at(number)], first_[at(number) + 1] - first_[at(number)]};
  }

  /// Of the shortest ways from a point to all others, straight from each to the next (Dijkstra 1959), in
  /// metres; infinity where there is none. Beyond the reach they may be too long.
  std::vector<float> lengths_from(std::int32_t start, const SearchReach& reach = {}) const;

 private:
  static std::size_t at(std::int32_t number) { return static_cast<std::size_t>(number); }

  std::vector<Eigen::Vector2d> points_m_;
  std::vector<std::uint32_t> first_{0};
  std::vector<std::int32_t> beside_;
};

}  // namespace isthmus
