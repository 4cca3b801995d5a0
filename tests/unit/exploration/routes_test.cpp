#include "server/exploration/routes.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace isthmus {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();

/// Robots and places on a line, by their coordinates.
RouteCosts on_a_line(const std::vector<double>& robots, const std::vector<double>& places) {
  RouteCosts costs;
  const auto row = [&](double from) {
    std::vector<double> lengths;
    for (const double to : places) lengths.push_back(std::abs(to - from));
    return lengths;
  };
  for (const double robot : robots) costs.from_robot.push_back(row(robot));
  for (const double place : places) costs.between.push_back(row(place));
  costs.work.assign(places.size(), 0);
  return costs;
}

TEST(Routes, OneRobotDoesWhatIsNearOnItsWayBeforeItGoesFar) {
  // The nearest is behind it: going there last would mean coming all the way back.
  const RouteCosts costs = on_a_line({0}, {-2, 3, 10});
  const std::vector<Route> routes = share_out(costs);
  EXPECT_EQ(routes[0], (Route{0, 1, 2}));
  EXPECT_EQ(route_m(costs, 0, routes[0]), 14);
}

TEST(Routes, TwoRobotsSideBySideGoApart) {
  const std::vector<Route> routes = share_out(on_a_line({0, 0.5}, {-6, -8, 7, 9}));
  EXPECT_EQ(routes[0], (Route{0, 1}));
  EXPECT_EQ(routes[1], (Route{2, 3}));
}

TEST(Routes, WorkIsSharedAndNotPlaces) {
  RouteCosts costs = on_a_line({0, 0}, {1, -1, -2, -3});
  costs.work[0] = 20;
  const std::vector<Route> routes = share_out(costs);
  EXPECT_EQ(std::min(routes[0].size(), routes[1].size()), 1U);  // one has enough to do there
  EXPECT_EQ(std::max(routes[0].size(), routes[1].size()), 3U);
}

TEST(Routes, WhereThereIsMuchToDoOnOneSideBothGoThere) {
  RouteCosts costs = on_a_line({0, 0}, {1, 2, 3, 4});
  costs.work.assign(4, 10);
  const std::vector<Route> routes = share_out(costs);
  EXPECT_EQ(routes[0].size(), 2U);
  EXPECT_EQ(routes[1].size(), 2U);
}

TEST(Routes, WhereThereIsMuchToDoOneGoesFirst) {
  // The way over all three is shorter if the robot begins on the left.
  RouteCosts costs = on_a_line({0}, {-5, 6, 8});
  EXPECT_EQ(share_out(costs)[0], (Route{0, 1, 2}));
  costs.work = {1, 10, 10};
  EXPECT_EQ(share_out(costs)[0], (Route{1, 2, 0}));
}

TEST(Routes, WhatNobodyCanReachMakesTheOthersNoLessUrgent) {
  RouteCosts costs = on_a_line({0}, {-5, 6, 8, 50});
  costs.work = {1, 10, 10, 1e6};
  costs.from_robot[0][3] = infinity;
  EXPECT_EQ(share_out(costs)[0], (Route{1, 2, 0}));
}

TEST(Routes, TheLongestIsShortThoughOneAloneWouldDriveLessInAll) {
  const RouteCosts costs{{{10, 10}, {11, 11}}, {{0, 6}, {6, 0}}, {0, 0}};
  for (const Route& route : share_out(costs)) EXPECT_EQ(route.size(), 1U);
}

TEST(Routes, APlaceThatNobodyCanReachIsInNoRoute) {
  RouteCosts costs = on_a_line({0, 5}, {1, 2});
  costs.from_robot[0] = {infinity, 2};
  costs.from_robot[1] = {infinity, infinity};
  const std::vector<Route> routes = share_out(costs);
  EXPECT_EQ(routes[0], (Route{1}));
  EXPECT_TRUE(routes[1].empty());
}

TEST(Routes, WithoutPlacesAndWithoutRobotsThereAreNone) {
  EXPECT_TRUE(share_out(on_a_line({0}, {})).at(0).empty());
  EXPECT_TRUE(share_out(on_a_line({}, {1})).empty());
}

}  // namespace
}  // namespace isthmus
