#include "server/exploration/routes.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace isthmus {
namespace {

constexpr int max_rounds = 30;
constexpr double worth_it_m = 1e-6;

/// What a route takes.
struct Taken {
  double length_m = 0;
  double waited = 0;  ///< metres until a place is reached times its work, over all places
};

Taken taken(const RouteCosts& costs, std::size_t robot, const Route& route) {
  Taken sum;
  for (std::size_t at = 0; at < route.size(); ++at) {
    const std::size_t place = route[at];
    sum.length_m += at == 0 ? costs.from_robot[robot][place] : costs.between[route[at - 1]][place];
    sum.waited += sum.length_m * costs.work[place];
    sum.length_m += costs.work[place];
  }
  return sum;
}

/// Of all places that somebody can reach.
double reachable_work(const RouteCosts& costs) {
  double sum = 0;
  for (std::size_t place = 0; place < costs.work.size(); ++place)
    if (std::ranges::any_of(costs.from_robot, [&](const auto& row) { return row[place] < no_way; }))
      sum += costs.work[place];
  return sum;
}

class RouteBuilder {
 public:
  explicit RouteBuilder(const RouteCosts& costs)
      : costs_(costs),
        reachable_work_(reachable_work(costs)),
        routes_(costs.from_robot.size()),
        taken_(routes_.size()) {}

  void insert_all() {
    std::vector<std::size_t> left(costs_.work.size());
    std::iota(left.begin(), left.end(), 0);
    while (!left.empty()) {
      Placing best;
      for (const std::size_t place : left) {
        const Placing placing = best_placing(place);
        if (placing.cost < best.cost) best = placing;
      }
      if (best.cost == no_way) return;
      insert(best);
      std::erase(left, best.place);
    }
  }

  void improve() {
    for (int round = 0; round < max_rounds; ++round)
      if (!move_places() && !turn_stretches()) return;
  }

  std::vector<Route> take() { return std::move(routes_); }

 private:
  struct Placing {
    double cost = no_way;
    std::size_t place = 0, robot = 0, at = 0;
  };

  /// Of the team, if a robot's route takes so much.
  double cost_with(std::size_t robot, const Taken& tried) const {
    double longest = tried.length_m, sum = tried.length_m, waited = tried.waited;
    for (std::size_t other = 0; other < taken_.size(); ++other) {
      if (other == robot) continue;
      longest = std::max(longest, taken_[other].length_m);
      sum += taken_[other].length_m;
      waited += taken_[other].waited;
    }
    return longest + sum / static_cast<double>(taken_.size()) +
           (reachable_work_ > 0 ? waited / reachable_work_ : 0);
  }

  Placing best_placing(std::size_t place) const {
    Placing best;
    for (std::size_t robot = 0; robot < routes_.size(); ++robot) {
      if (costs_.from_robot[robot][place] == no_way) continue;
      Route with = routes_[robot];
      with.push_back(place);
      for (std::size_t at = routes_[robot].size();; --at) {
        const double cost = cost_with(robot, taken(costs_, robot, with));
        if (cost < best.cost) best = {cost, place, robot, at};
        if (at == 0) break;
        std::swap(with[at], with[at - 1]);
      }
    }
    return best;
  }

  void insert(const Placing& placing) {
    Route& route = routes_[placing.robot];
    route.insert(route.begin() + static_cast<std::ptrdiff_t>(placing.at), placing.place);
    taken_[placing.robot] = taken(costs_, placing.robot, route);
  }

  bool move_places() {
    bool moved = false;
    for (std::size_t robot = 0; robot < routes_.size(); ++robot) {
      for (std::size_t at = 0; at < routes_[robot].size(); ++at) {
        const double before = cost_with(robot, taken_[robot]);
        const Route kept = routes_[robot];
        const std::size_t place = kept[at];
        routes_[robot].erase(routes_[robot].begin() + static_cast<std::ptrdiff_t>(at));
        taken_[robot] = taken(costs_, robot, routes_[robot]);
        const Placing placing = best_placing(place);
        if (placing.cost < before - worth_it_m) {
          insert(placing);
          moved = true;
        } else {
          routes_[robot] = kept;
          taken_[robot] = taken(costs_, robot, kept);
        }
      }
    }
    return moved;
  }

  bool turn_stretches() {
    bool turned = false;
    for (std::size_t robot = 0; robot < routes_.size(); ++robot) {
      Route& route = routes_[robot];
      for (auto first = route.begin(); first != route.end(); ++first) {
        for (auto last = first + 1; last != route.end(); ++last) {
          const double before = cost_with(robot, taken_[robot]);
          std::reverse(first, last + 1);
          const Taken tried = taken(costs_, robot, route);
          if (cost_with(robot, tried) < before - worth_it_m) {
            taken_[robot] = tried;
            turned = true;
          } else {
            std::reverse(first, last + 1);
          }
        }
      }
    }
    return turned;
  }

  const RouteCosts& costs_;
  double reachable_work_;
  std::vector<Route> routes_;
  std::vector<Taken> taken_;  // by robot
};

}  // namespace

double route_m(const RouteCosts& costs, std::size_t robot, const Route& route) {
  return taken(costs, robot, route).length_m;
}

std::vector<Route> share_out(const RouteCosts& costs) {
  RouteBuilder routes(costs);
  routes.insert_all();
  routes.improve();
  return routes.take();
}

}  // namespace isthmus
