#include "tools/simulate/wild/tours.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "tools/simulate/plan/floor_legs.hpp"
#include "tools/simulate/plan/floor_routes.hpp"
#include "tools/simulate/plan/random.hpp"

namespace isthmus {
namespace {

using Eigen::Vector2d;

constexpr double nearest_wall_m = 0.8;  // of waypoints in rooms
constexpr double first_stop_m = 1.1;    // behind a door
constexpr double clearance_m = 0.4;     // of every way: what walls and furniture leave
constexpr double pause_at_end_s = 3;
constexpr double longest_person_m = 2500;

/// What one robot or person does.
struct Order {
  std::vector<Vector2d> loop;
  std::size_t first = 0;  ///< corner of the loop
  int laps = 1;
  double overlap_m = 20;
  double rooms_per_m = 0;
  double spins_per_m = 0;
};

class WildTraveller {
 public:
  WildTraveller(const WildLayout& layout, const FloorRoutes& routes, const Bend& bend, Random random)
      : layout_(layout), routes_(routes), bend_(bend), random_(random) {}

  WildTourPlan travel(const Order& order) {
    std::vector<std::size_t> corners;
    for (std::size_t i = 0; i < order.loop.size(); ++i)
      corners.push_back(nearest(order.loop[(order.first + i) % order.loop.size()]));
    at_ = nearest(order.loop[order.first]);
    last_ = routes_.position(at_);
    for (int lap = 0; lap < order.laps; ++lap) {
      for (std::size_t i = 1; i <= corners.size(); ++i) go_to(corners[i % corners.size()], order);
    }
    double left_m = order.overlap_m;
    for (std::size_t i = 1; i <= corners.size() && left_m > 0; ++i)
      left_m -= go_to(corners[i % corners.size()], order, left_m);
    flush();
    plan_.steps.emplace_back(Wait{pause_at_end_s});
    return std::move(plan_);
  }

 private:
  // Corridors meet, or end in a lobby, at one node at least.
  std::size_t nearest(const Vector2d& point) const {
    std::size_t best = routes_.crossings().front();
    const auto consider = [&](std::size_t node) {
      if ((routes_.position(node) - point).norm() < (routes_.position(best) - point).norm()) best = node;
    };
    for (const std::size_t node : routes_.crossings()) consider(node);
    for (const FloorStop& stop : routes_.stops()) consider(stop.node);
    return best;
  }

  // The way driven, at most about `max_m`.
  double go_to(std::size_t node, const Order& order, double max_m = std::numeric_limits<double>::infinity()) {
    const auto way = FloorRoutes::way_to(routes_.ways_from(at_), node);
    double driven_m = 0;
    for (std::size_t i = 1; i < way.size() && driven_m < max_m; ++i) {
      const Vector2d &from = routes_.position(way[i - 1]), &to = routes_.position(way[i]);
      const double lane_m = routes_.lane_m(way[i - 1], way[i]), length_m = (to - from).norm();
      if (random_.chance(order.spins_per_m * length_m)) {
        const Vector2d between = from + random_.uniform(0.2, 0.8) * (to - from);
        add(from, between, lane_m);
        spin();
        add(between, to, lane_m);
      } else {
        add(from, to, lane_m);
      }
      driven_m += length_m;
      at_ = way[i];
      visit(order.rooms_per_m * length_m);
    }
    return driven_m;
  }

  // Perhaps into a room here, mostly aside there, and out again.
  void visit(double chance) {
    for (const FloorStop& stop : routes_.stops()) {
      if (stop.node != at_ || !random_.chance(chance)) continue;
      const FloorCell& room = layout_.floor.cells[stop.room];
      const double deep = std::abs(stop.inward.dot(room.size())) - nearest_wall_m;
      if (deep < first_stop_m) continue;
      plan_.rooms.insert(stop.room);
      const Vector2d before = routes_.position(at_);
      const Vector2d inside = stop.door + random_.uniform(first_stop_m, std::min(deep, 12.0)) * stop.inward;
      add(before, inside, 0);
      const int across = std::abs(stop.inward.x()) > 0.5 ? 1 : 0;
      Vector2d aside = inside;
      aside[across] = random_.uniform(std::max(room.low[across] + nearest_wall_m, inside[across] - 10),
                                      std::min(room.high[across] - nearest_wall_m, inside[across] + 10));
      if (std::abs(aside[across] - inside[across]) > 0.5) {
        add(inside, aside, 0);
        add(aside, inside, 0);
      }
      add(inside, before, 0);
    }
  }

  void spin() {
    flush();
    const double turn = random_.uniform(1, 2.5) * std::numbers::pi;
    plan_.steps.emplace_back(Turn{random_.chance(0.5) ? turn : -turn});
  }

  void add(const Vector2d& from, const Vector2d& to, double lane_m) {
    if ((to - from).norm() > 0.05) legs_.push_back({from, to, lane_m});
  }

  // Begins where the first way does.
  void flush() {
    if (legs_.empty()) return;
    if (plan_.ways.empty()) begin();
    for (const Vector2d& point : waypoints_of(legs_)) {
      for (const Vector2d& bent : bend_.line(last_, point))
        plan_.steps.emplace_back(Waypoint{bent, clearance_m});
      plan_.ways.push_back({last_, point});
      last_ = point;
    }
    legs_.clear();
  }

  void begin() {
    last_ = legs_.front().from + legs_.front().offset();
    const Vector2d start = bend_(last_), ahead = bend_(last_ + 0.1 * legs_.front().direction());
    plan_.start = {start.x(), start.y(), std::atan2(ahead.y() - start.y(), ahead.x() - start.x())};
  }

  const WildLayout& layout_;
  const FloorRoutes& routes_;
  const Bend& bend_;
  Random random_;
  std::size_t at_ = 0;
  Vector2d last_ = Vector2d::Zero();  // where the last waypoint is
  std::vector<FloorLeg> legs_;
  WildTourPlan plan_;
};

// There and back where there is but one way.
std::vector<Vector2d> lap_of(std::vector<Vector2d> loop, const WildBuilding& building, bool backwards) {
  if (building.corridors_along_x == 1) {
    for (std::size_t i = loop.size() - 1; i-- > 1;) loop.push_back(loop[i]);
  }
  if (backwards) std::ranges::reverse(loop);
  return loop;
}

Order order_of(const WildDraw& draw, const WildLayout& layout, const WildRobot& robot, Random& random) {
  Order order;
  const std::size_t loop = robot.own_loop ? random.index(layout.loops.size()) : 0;
  order.loop = lap_of(layout.loops[loop], draw.building, robot.backwards);
  order.first = random.index(order.loop.size());
  order.laps = draw.tour.laps;
  order.overlap_m = draw.tour.overlap_m;
  order.rooms_per_m = draw.tour.rooms_per_100m / 100;
  order.spins_per_m = draw.tour.spins_per_100m / 100;
  return order;
}

}  // namespace

std::vector<WildTourPlan> plan_wild_tours(const WildDraw& draw, const WildLayout& layout, const Bend& bend) {
  const FloorRoutes routes(layout.floor);
  std::vector<WildTourPlan> plans;
  for (std::size_t i = 0; i < draw.robots.size() + static_cast<std::size_t>(draw.people); ++i) {
    Random random(draw.seed, "wild tour " + std::to_string(i));
    WildRobot who = draw.robots[std::min(i, draw.robots.size() - 1)];
    const bool person = i >= draw.robots.size();
    if (person) who.backwards = random.chance(0.5);
    Order order = order_of(draw, layout, who, random);
    if (person) {
      order.laps = std::clamp(static_cast<int>(longest_person_m / draw.tour.loop_m), 1, 4 * draw.tour.laps);
      order.spins_per_m = 0;
    }
    plans.push_back(WildTraveller(layout, routes, bend, random).travel(order));
  }
  return plans;
}

}  // namespace isthmus
