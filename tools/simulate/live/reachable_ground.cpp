#include "tools/simulate/live/reachable_ground.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>

namespace isthmus {

ReachableGround::ReachableGround(const FloorPlan& plan, const RayCaster& caster, const Eigen::Vector2d& start,
                                 double room_m) {
  const Eigen::Vector2i size = ((plan.high - plan.low) / spacing_m).array().ceil().cast<int>() + 1;
  const Eigen::Vector2i first = ((start - plan.low) / spacing_m).array().round().cast<int>();
  std::vector<std::uint8_t> seen(static_cast<std::size_t>(size.x()) * static_cast<std::size_t>(size.y()));
  std::vector<Eigen::Vector2i> open;
  const auto visit = [&](const Eigen::Vector2i& at) {
    if ((at.array() < 0).any() || (at.array() >= size.array()).any()) return;
    const auto i = static_cast<std::size_t>(at.y()) * static_cast<std::size_t>(size.x()) +
                   static_cast<std::size_t>(at.x());
    if (seen[i]) return;
    seen[i] = 1;
    const Eigen::Vector2d point = plan.low + spacing_m * at.cast<double>();
    if (caster.touches(point, room_m)) return;
    points_.push_back(point);
    open.push_back(at);
  };
  visit(first);
  while (!open.empty()) {
    const Eigen::Vector2i at = open.back();
    open.pop_back();
    for (const Eigen::Vector2i& by :
         {Eigen::Vector2i(1, 0), Eigen::Vector2i(-1, 0), Eigen::Vector2i(0, 1), Eigen::Vector2i(0, -1)})
      visit(at + by);
  }
}

std::vector<Eigen::Vector2d> starts_beside(const RayCaster& caster, const Eigen::Vector2d& first,
                                           std::size_t robots, double room_m) {
  constexpr double apart_m = 0.9, farthest_m = 6;
  std::vector<Eigen::Vector2d> starts{first};
  for (double ring_m = apart_m; starts.size() < robots && ring_m < farthest_m; ring_m += apart_m / 2) {
    const int places = static_cast<int>(2 * std::numbers::pi * ring_m / (apart_m / 2));
    for (int i = 0; i < places && starts.size() < robots; ++i) {
      const double angle = 2 * std::numbers::pi * i / places;
      const Eigen::Vector2d at = first + ring_m * Eigen::Vector2d(std::cos(angle), std::sin(angle));
      const bool apart = std::all_of(starts.begin(), starts.end(), [&](const Eigen::Vector2d& other) {
        return (other - at).norm() >= apart_m;
      });
      if (apart && !caster.touches(at, room_m) && caster.line_of_sight(first, at)) starts.push_back(at);
    }
  }
  if (starts.size() < robots) throw std::runtime_error("there is no room for the robots to start");
  return starts;
}

}  // namespace isthmus
