#include "server/exploration/routes.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace isthmus {
namespace {

constexpr int max_rounds = 30;
constexpr double worth_it_m = 1e-6;

class RouteBuilder {
 public:
  explicit RouteBuilder(const RouteCosts& costs)
      : costs_(costs), routes_(costs.from_robot.size()), lengths_(costs.from_robot.size(), 0) {}

  void insert_all() {
    std::vector<std::size_t> left(costs_.work.size());
    std::iota(left.begin(), left.end(), 0);
    while (!left.empty()) {
      Placing best;
      for (std::size_t i = 0; i < left.size(); ++i) {
        const Placing placing = best_placing(left[i]);
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

  double cost_with(std::size_t robot, double length) const {
    double longest = length, sum = length;
    for (std::size_t other = 0; other < lengths_.size(); ++other) {
      if (other == robot) continue;
      longest = std::max(longest, lengths_[other]);
      sum += lengths_[other];
    }
    return longest + sum / static_cast<double>(lengths_.size());
  }

  double step_m(std::size_t robot, const Route& route, std::size_t at, std::size_t place) const {
    return at == 0 ? costs_.from_robot[robot][place] : costs_.between[route[at - 1]][place];
  }

  /// A route's length with a place put in.
  double longer(std::size_t robot, std::size_t at, std::size_t place) const {
    const Route& route = routes_[robot];
    double by = step_m(robot, route, at, place) + costs_.work[place];
    if (at < route.size()) by += costs_.between[place][route[at]] - step_m(robot, route, at, route[at]);
    return lengths_[robot] + by;
  }

  Placing best_placing(std::size_t place) const {
    Placing best;
    for (std::size_t robot = 0; robot < routes_.size(); ++robot) {
      if (costs_.from_robot[robot][place] == no_way) continue;
      for (std::size_t at = 0; at <= routes_[robot].size(); ++at) {
        const double cost = cost_with(robot, longer(robot, at, place));
        if (cost < best.cost) best = {cost, place, robot, at};
      }
    }
    return best;
  }

  void insert(const Placing& placing) {
    Route& route = routes_[placing.robot];
    route.insert(route.begin() + static_cast<std::ptrdiff_t>(placing.at), placing.place);
    lengths_[placing.robot] = route_m(costs_, placing.robot, route);
  }

  double cost() const { return cost_with(0, lengths_.empty() ? 0 : lengths_[0]); }

  bool move_places() {
    bool moved = false;
    for (std::size_t robot = 0; robot < routes_.size(); ++robot) {
      for (std::size_t at = 0; at < routes_[robot].size(); ++at) {
        const double before = cost();
        const Route kept = routes_[robot];
        const std::size_t place = kept[at];
        routes_[robot].erase(routes_[robot].begin() + static_cast<std::ptrdiff_t>(at));
        lengths_[robot] = route_m(costs_, robot, routes_[robot]);
        const Placing placing = best_placing(place);
        if (placing.cost < before - worth_it_m) {
          insert(placing);
          moved = true;
        } else {
          routes_[robot] = kept;
          lengths_[robot] = route_m(costs_, robot, kept);
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
          std::reverse(first, last + 1);
          const double length = route_m(costs_, robot, route);
          if (length < lengths_[robot] - worth_it_m) {
            lengths_[robot] = length;
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
  std::vector<Route> routes_;
  std::vector<double> lengths_;
};

}  // namespace

double route_m(const RouteCosts& costs, std::size_t robot, const Route& route) {
  double length = 0;
  for (std::size_t at = 0; at < route.size(); ++at)
    length += (at == 0 ? costs.from_robot[robot][route[at]] : costs.between[route[at - 1]][route[at]]) +
              costs.work[route[at]];
  return length;
}

std::vector<Route> share_out(const RouteCosts& costs) {
  RouteBuilder routes(costs);
  routes.insert_all();
  routes.improve();
  return routes.take();
}

}  // namespace isthmus
