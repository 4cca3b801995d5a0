#include "tools/simulate/plan/floor_tours.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <stdexcept>

#include "tools/simulate/plan/floor_legs.hpp"
#include "tools/simulate/plan/floor_routes.hpp"
#include "tools/simulate/plan/random.hpp"

namespace isthmus {
namespace {

using Eigen::Vector2d;

constexpr double stop_from_wall_m = 0.75;  // of waypoints in rooms
constexpr double stop_from_door_m = 1.1;   // from the door
constexpr int robots_in_a_group = 4;
constexpr double row_m = 0.9;    // between two pairs that gather in a room
constexpr double aside_m = 0.7;  // of each of a pair, from the door's axis
constexpr int candidates = 5;
constexpr double visit_costs_m = 40;  // a room seen before counts as so much farther

// Makes one robot's legs.
class FloorVisitor {
 public:
  FloorVisitor(const FloorLayout& layout, const FloorRoutes& routes, Random& random, const FloorStop& home)
      : layout_(layout), routes_(routes), random_(random), at_(home.node) {
    start_ = home.door + std::min(deepest(home), random_.uniform(stop_from_door_m, 2.5)) * home.inward;
    const Vector2d out = -home.inward;
    tour_.start = {start_.x(), start_.y(), std::atan2(out.y(), out.x())};
    add(start_, routes_.position(at_), 0);
  }

  double length_m() const { return length_m_; }
  std::size_t at() const { return at_; }

  void go_to(std::size_t node) {
    const auto way = FloorRoutes::way_to(routes_.ways_from(at_), node);
    for (std::size_t i = 1; i < way.size(); ++i) {
      add(routes_.position(way[i - 1]), routes_.position(way[i]), routes_.lane_m(way[i - 1], way[i]));
    }
    at_ = node;
  }

  // Into the room, mostly aside there, and out again.
  void visit(const FloorStop& stop) {
    go_to(stop.node);
    const Vector2d before = routes_.position(stop.node);
    const Vector2d inside = stop.door + random_.uniform(0.5, 1) * deepest(stop) * stop.inward;
    add(before, inside, 0);
    if (random_.chance(0.7)) {
      const FloorCell& room = layout_.cells[stop.room];
      const int across = std::abs(stop.inward.x()) > 0.5 ? 1 : 0;
      Vector2d aside = inside;
      aside[across] =
          random_.uniform(room.low[across] + stop_from_wall_m, room.high[across] - stop_from_wall_m);
      if (std::abs(aside[across] - inside[across]) > 0.4) {
        add(inside, aside, 0);
        add(aside, inside, 0);
      }
    }
    add(inside, before, 0);
  }

  // Into the room to stay, in the pair nearest the door or in one `rows` behind it.
  void gather(const FloorStop& stop, int rows, bool left) {
    go_to(stop.node);
    const Vector2d inside = stop.door + (stop_from_door_m + rows * row_m) * stop.inward;
    const Vector2d side(-stop.inward.y(), stop.inward.x());
    add(routes_.position(stop.node), inside, 0);
    add(inside, inside + (left ? aside_m : -aside_m) * side, 0);
  }

  FloorTour tour() {
    tour_.waypoints = waypoints_of(legs_);
    return std::move(tour_);
  }

 private:
  double deepest(const FloorStop& stop) const {
    const FloorCell& room = layout_.cells[stop.room];
    return std::abs(stop.inward.dot(room.size())) - stop_from_wall_m;
  }

  void add(const Vector2d& from, const Vector2d& to, double lane_m) {
    const double length = (to - from).norm();
    if (length < 1e-6) return;
    length_m_ += length;
    legs_.push_back({from, to, lane_m});
  }

  const FloorLayout& layout_;
  const FloorRoutes& routes_;
  Random& random_;
  std::size_t at_;
  Vector2d start_;
  FloorTour tour_;
  std::vector<FloorLeg> legs_;
  double length_m_ = 0;
};

// Plans all robots' tours, so that together they see the floor.
class Team {
 public:
  Team(const FloorLayout& layout, const FloorStyle& style, int robots)
      : layout_(layout),
        routes_(layout),
        random_(style.seed, "floor tours"),
        visits_(layout.cells.size(), 0) {
    for (const FloorStop& stop : routes_.stops()) {
      if (std::abs(stop.inward.dot(layout.cells[stop.room].size())) > stop_from_door_m + stop_from_wall_m)
        stops_.push_back(stop);
    }
    choose_hubs(robots);
  }

  std::vector<FloorTour> plan(int robots, double tour_m) {
    std::vector<FloorVisitor> travellers;
    for (const std::size_t home : homes(robots)) {
      ++visits_[stops_[home].room];
      travellers.emplace_back(layout_, routes_, random_, stops_[home]);
    }
    for (bool any = true; any;) {
      any = false;
      for (FloorVisitor& traveller : travellers) {
        if (traveller.length_m() > tour_m) continue;
        travel(traveller);
        any = true;
      }
    }
    std::vector<FloorTour> tours;
    std::optional<FloorStop> meeting;
    int rows = 0;
    for (std::size_t i = 0; i < travellers.size(); ++i) {
      const int place = static_cast<int>(i) % robots_in_a_group;
      if (place == 0) {
        rows = std::min(robots_in_a_group, static_cast<int>(travellers.size() - i)) > 2 ? 1 : 0;
        meeting = meeting_place(travellers[i].at(), rows);
      }
      if (meeting) travellers[i].gather(*meeting, place < 2 ? rows : 0, place % 2 == 0);
      tours.push_back(travellers[i].tour());
    }
    return tours;
  }

 private:
  void choose_hubs(int robots) {
    const auto& nodes = routes_.crossings();
    for (int i = 0; i < 1 + robots / 6 && !nodes.empty(); ++i)
      hubs_.push_back(nodes[random_.index(nodes.size())]);
  }

  // A stop for each robot, no two in one room.
  std::vector<std::size_t> homes(int robots) {
    std::vector<std::size_t> order(stops_.size());
    for (std::size_t i = 0; i < order.size(); ++i) order[i] = i;
    for (std::size_t i = order.size(); i > 1; --i) std::swap(order[i - 1], order[random_.index(i)]);
    std::vector<std::size_t> chosen;
    std::vector<bool> taken(layout_.cells.size(), false);
    for (const std::size_t stop : order) {
      if (static_cast<int>(chosen.size()) == robots) break;
      if (taken[stops_[stop].room]) continue;
      taken[stops_[stop].room] = true;
      chosen.push_back(stop);
    }
    if (static_cast<int>(chosen.size()) < robots) {
      throw std::runtime_error("the floor has " + std::to_string(chosen.size()) + " rooms to start in, for " +
                               std::to_string(robots) + " robots");
    }
    return chosen;
  }

  // To two rooms and past a busy crossing.
  void travel(FloorVisitor& traveller) {
    for (int i = 0; i < 2; ++i) {
      const FloorStop& stop = next_stop(traveller.at());
      ++visits_[stop.room];
      traveller.visit(stop);
    }
    if (!hubs_.empty()) traveller.go_to(hubs_[random_.index(hubs_.size())]);
  }

  const FloorStop& next_stop(std::size_t at) {
    const FloorRoutes::Ways ways = routes_.ways_from(at);
    const FloorStop* best = nullptr;
    double best_cost = 0;
    for (int i = 0; i < candidates; ++i) {
      const FloorStop& stop = stops_[random_.index(stops_.size())];
      const double cost = ways.distance_m[stop.node] + visit_costs_m * visits_[stop.room];
      if (best == nullptr || cost < best_cost) {
        best = &stop;
        best_cost = cost;
      }
    }
    return *best;
  }

  // A near room that few others visit, with room for a pair and as many rows behind it.
  std::optional<FloorStop> meeting_place(std::size_t at, int rows) const {
    const FloorRoutes::Ways ways = routes_.ways_from(at);
    const FloorStop* best = nullptr;
    double best_cost = 0;
    for (const FloorStop& stop : stops_) {
      const FloorCell& room = layout_.cells[stop.room];
      const int across = std::abs(stop.inward.x()) > 0.5 ? 1 : 0;
      const double deep = std::abs(stop.inward.dot(room.size()));
      const double beside =
          std::min(stop.door[across] - room.low[across], room.high[across] - stop.door[across]);
      if (deep < stop_from_door_m + rows * row_m + stop_from_wall_m || beside < aside_m + 0.4) continue;
      const double cost = ways.distance_m[stop.node] + visit_costs_m * visits_[stop.room];
      if (best != nullptr && cost >= best_cost) continue;
      best = &stop;
      best_cost = cost;
    }
    return best == nullptr ? std::nullopt : std::optional(*best);
  }

  const FloorLayout& layout_;
  FloorRoutes routes_;
  Random random_;
  std::vector<FloorStop> stops_;
  std::vector<int> visits_;
  std::vector<std::size_t> hubs_;
};

}  // namespace

std::vector<FloorTour> plan_tours(const FloorLayout& layout, const FloorStyle& style, int robots,
                                  double tour_m) {
  if (tour_m <= 0) tour_m = 4 * std::sqrt(style.area_m2) + 0.5 * style.area_m2 / robots;
  return Team(layout, style, robots).plan(robots, tour_m);
}

}  // namespace isthmus
