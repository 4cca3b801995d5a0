#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "server/exploration/routes.hpp"

namespace isthmus {
namespace {

struct Point {
  double x, y;
};

Point any_point() { return {0.1 * *rc::gen::inRange(0, 500), 0.1 * *rc::gen::inRange(0, 500)}; }

RouteCosts any_costs(std::size_t robots, std::size_t places) {
  std::vector<Point> at, from;
  for (std::size_t i = 0; i < places; ++i) at.push_back(any_point());
  for (std::size_t i = 0; i < robots; ++i) from.push_back(any_point());
  RouteCosts costs;
  const auto row = [&](const Point& start) {
    std::vector<double> lengths;
    for (const Point& end : at) lengths.push_back(std::hypot(end.x - start.x, end.y - start.y));
    return lengths;
  };
  for (const Point& start : from) costs.from_robot.push_back(row(start));
  for (const Point& start : at) costs.between.push_back(row(start));
  for (std::size_t i = 0; i < places; ++i) costs.work.push_back(*rc::gen::inRange(0, 10));
  return costs;
}

RC_GTEST_PROP(RoutesProperty, EachPlaceIsInOneRouteOnce, ()) {
  const std::size_t robots = *rc::gen::inRange<std::size_t>(1, 6);
  const std::size_t places = *rc::gen::inRange<std::size_t>(0, 15);
  std::vector<std::size_t> found;
  for (const Route& route : share_out(any_costs(robots, places)))
    found.insert(found.end(), route.begin(), route.end());
  std::sort(found.begin(), found.end());
  std::vector<std::size_t> all(places);
  std::iota(all.begin(), all.end(), 0);
  RC_ASSERT(found == all);
}

RC_GTEST_PROP(RoutesProperty, OneRobotsRouteIsHardlyLongerThanTheShortest, ()) {
  const RouteCosts costs = any_costs(1, *rc::gen::inRange<std::size_t>(1, 7));
  Route order(costs.work.size());
  std::iota(order.begin(), order.end(), 0);
  double shortest = route_m(costs, 0, order);
  while (std::next_permutation(order.begin(), order.end()))
    shortest = std::min(shortest, route_m(costs, 0, order));
  RC_ASSERT(route_m(costs, 0, share_out(costs).at(0)) <= 1.35 * shortest + 1e-9);
}

}  // namespace
}  // namespace isthmus
