#include "server/paths/questions/driven_ways.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <queue>
#include <utility>

namespace isthmus {
namespace {

/// Rows farther apart than this are not one way: a restart, or a robot that was carried.
constexpr double max_step_m = 1.5;

bool is_on_map(const MapCopy& map, PatchId patch) {
  return patch.valid() && static_cast<std::size_t>(patch.value) < map.patches.size() &&
         !std::binary_search(map.left_out.begin(), map.left_out.end(), patch);
}

Pose project(const MapCopy& map, const ManifoldPose& pose) {
  return map.poses[static_cast<std::size_t>(pose.patch.value)] * pose.patch_from_object;
}

/// A way through places: from each to the one before and after it, and to where the way came by again.
class Crossings {
 public:
  /// `is_barred`: whether a robot comes into a keep-out zone straight from one point to another.
  using IsBarred = std::function<bool(const Eigen::Vector2d&, const Eigen::Vector2d&)>;

  Crossings(std::vector<Eigen::Vector2d> points, std::vector<PatchId> patches, const NearPatches& near,
            IsBarred is_barred)
      : points_(std::move(points)),
        patches_(std::move(patches)),
        near_(near),
        is_barred_(std::move(is_barred)) {
    for (std::size_t i = 0; i < points_.size(); ++i) at_[square_of(points_[i])].push_back(i);
  }

  /// Places from `from` to `to`; empty where there is no way.
  std::vector<std::size_t> shortest(std::size_t from, std::size_t to) const {
    using Entry = std::pair<double, std::size_t>;
    std::vector<double> length(points_.size(), std::numeric_limits<double>::infinity());
    std::vector<std::size_t> before(points_.size(), from);
    std::priority_queue<Entry, std::vector<Entry>, std::greater<>> waiting;
    length[from] = 0;
    waiting.emplace(0.0, from);
    while (!waiting.empty() && waiting.top().second != to) {
      const auto [way, at] = waiting.top();
      waiting.pop();
      if (way > length[at]) continue;
      visit_next(at, [&, way = way, at = at](std::size_t next) {
        const double longer = way + (points_[next] - points_[at]).norm();
        if (!(longer < length[next])) return;
        length[next] = longer;
        before[next] = at;
        waiting.emplace(longer, next);
      });
    }
    if (waiting.empty()) return {};
    std::vector<std::size_t> way{to};
    while (way.back() != from) way.push_back(before[way.back()]);
    std::reverse(way.begin(), way.end());
    return way;
  }

 private:
  using Square = std::pair<int, int>;
  static Square square_of(const Eigen::Vector2d& point) {
    return {static_cast<int>(std::floor(point.x() / DrivenWays::crossing_m)),
            static_cast<int>(std::floor(point.y() / DrivenWays::crossing_m))};
  }

  bool joined(std::size_t a, std::size_t b, double max_m, double max_near_m) const {
    return (points_[a] - points_[b]).norm() <= max_m && near_.way_m(patches_[a], patches_[b]) <= max_near_m &&
           !is_barred_(points_[a], points_[b]);
  }

  template <class Visit>
  void visit_next(std::size_t at, const Visit& visit) const {
    constexpr double any = std::numeric_limits<double>::infinity();
    if (at > 0 && joined(at, at - 1, max_step_m, any)) visit(at - 1);
    if (at + 1 < points_.size() && joined(at, at + 1, max_step_m, any)) visit(at + 1);
    const auto [x, y] = square_of(points_[at]);
    for (int dx = -1; dx <= 1; ++dx) {
      for (int dy = -1; dy <= 1; ++dy) {
        const auto square = at_.find({x + dx, y + dy});
        if (square == at_.end()) continue;
        for (const std::size_t other : square->second)
          if (other != at && joined(at, other, DrivenWays::crossing_m, DrivenWays::crossing_near_m))
            visit(other);
      }
    }
  }

  std::vector<Eigen::Vector2d> points_;
  std::vector<PatchId> patches_;
  const NearPatches& near_;
  IsBarred is_barred_;
  std::map<Square, std::vector<std::size_t>> at_;
};

}  // namespace

void DrivenWays::update(const MapCopy& map) {
  if (map.trajectory != trajectory_) {
    trajectory_ = map.trajectory;
    rows_ = 0;
    places_.clear();
  }
  while (trajectory_ && rows_ < map.trajectory_rows) {
    constexpr std::size_t at_once = 10'000;
    const auto rows = trajectory_->read(rows_, std::min(at_once, map.trajectory_rows - rows_));
    if (rows.empty()) return;  // the disk refused them
    rows_ += rows.size();
    for (const TrajectoryRow& row : rows) add(row, map);
  }
}

void DrivenWays::add(const TrajectoryRow& row, const MapCopy& map) {
  if (!row.patch.valid() || static_cast<std::size_t>(row.patch.value) >= map.patches.size()) return;
  std::vector<Place>& places = places_[row.session];
  const Place place{row.utime, {row.patch, row.patch_from_robot}};
  if (places.size() >= 2) {
    const Eigen::Vector2d kept = position(project(map, places[places.size() - 2].pose));
    if ((position(project(map, place.pose)) - kept).norm() < spacing_m) places.pop_back();
  }
  places.push_back(place);
}

Path DrivenWays::back(const MapCopy& map, const NearPatches& near, const Zones& zones,
                      const std::string& robot, std::int64_t to_utime, double radius_m) const {
  const auto last = std::find_if(map.sessions.rbegin(), map.sessions.rend(), [&](const Session& session) {
    return session.robot == robot && places_.contains(session.number);
  });
  if (last == map.sessions.rend()) return {Refusal::unknown_robot, {}, 0, {}};
  std::vector<ManifoldPose> poses;
  std::vector<Eigen::Vector2d> points;
  std::vector<PatchId> patches;
  std::optional<std::size_t> to;
  for (const Place& place : places_.at(last->number)) {
    if (!is_on_map(map, place.pose.patch)) continue;
    if (!to && place.utime >= to_utime) to = poses.size();
    poses.push_back(place.pose);
    points.push_back(position(project(map, place.pose)));
    patches.push_back(place.pose.patch);
  }
  if (!to) return {poses.empty() ? Refusal::unknown_robot : Refusal::bad_value, {}, 0, {}};
  const IslandId island = map.graph.island(patches.back());
  const auto search = [&](const Crossings::IsBarred& is_barred) {
    return Crossings(points, patches, near, is_barred).shortest(poses.size() - 1, *to);
  };
  const std::vector<std::size_t> way =
      search([&](const auto& a, const auto& b) { return zones.bars(island, a, b, radius_m); });
  if (way.empty()) {
    const bool kept_out =
        zones.any_keep_out(island) && !search([](const auto&, const auto&) { return false; }).empty();
    return {kept_out ? Refusal::kept_out : Refusal::unreachable, {}, 0, {}};
  }
  Path path{Refusal::none, {poses[way.front()]}, 0, {0}};
  for (std::size_t i = 1; i < way.size(); ++i) {
    const Eigen::Vector2d by = points[way[i]] - points[way[i - 1]];
    const ManifoldPose& there = poses[way[i]];
    const double map_yaw = map.poses[static_cast<std::size_t>(there.patch.value)].yaw;
    const double yaw =
        by.norm() > 0 ? wrap_angle(std::atan2(by.y(), by.x()) - map_yaw) : there.patch_from_object.yaw;
    path.poses.push_back({there.patch, {there.patch_from_object.x, there.patch_from_object.y, yaw}});
    path.length_m += by.norm();
    path.max_speeds_m_s.push_back(zones.max_speed_m_s(island, points[way[i - 1]], points[way[i]], radius_m));
  }
  return path;
}

}  // namespace isthmus
