#include "server/output/vector_plan/vector_plan.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include "patches/segment.hpp"
#include "server/output/vector_plan/line_grid.hpp"
#include "server/output/vector_plan/sight_lines.hpp"
#include "server/output/vector_plan/stretches.hpp"
#include "server/output/vector_plan/wall_fit.hpp"

namespace isthmus {
namespace {

/// Sine of the angle at which an end comes to a wall: where it is flatter there is no corner.
constexpr double min_facing = 0.3;

/// A wall, and how far either end may be drawn on to a corner.
struct DrawnWall {
  PlanWall wall;
  double room_a_m = 0;
  double room_b_m = 0;
};

/// An end that looks for a wall to come to.
struct LooseEnd {
  Eigen::Vector2d at = Eigen::Vector2d::Zero();
  Eigen::Vector2d outwards = Eigen::Vector2d::UnitX();
  double room_m = 0;
};

/// How far an end has to reach on to come to another wall, which may reach on itself; negative where it is
/// too long. Nothing where they do not meet.
std::optional<double> reach_to_meet(const LooseEnd& end, const DrawnWall& other, double max_back_m) {
  const PlanWall& wall = other.wall;
  const double length = (wall.b - wall.a).norm();
  const Eigen::Vector2d along = (wall.b - wall.a) / length;
  const Eigen::Vector2d across(along.y(), -along.x());
  const double facing = across.dot(end.outwards);
  if (std::abs(facing) < min_facing) return std::nullopt;
  const double beyond = across.dot(wall.a - end.at) / facing;
  const double at = along.dot(end.at + beyond * end.outwards - wall.a);
  if (beyond > end.room_m || beyond < -max_back_m) return std::nullopt;
  if (at < -other.room_a_m || at > length + other.room_b_m) return std::nullopt;
  return beyond;
}

/// The end moved to the nearest wall that it comes to.
Eigen::Vector2d met(const LooseEnd& end, const std::vector<DrawnWall>& walls, const LineGrid& grid,
                    std::size_t own, double max_back_m) {
  std::optional<double> best;
  for (const int i : grid.near(end.at - max_back_m * end.outwards, end.at + end.room_m * end.outwards)) {
    const auto k = static_cast<std::size_t>(i);
    if (k == own) continue;
    const std::optional<double> beyond = reach_to_meet(end, walls[k], max_back_m);
    if (beyond && (!best || std::abs(*beyond) < std::abs(*best))) best = beyond;
  }
  return best ? Eigen::Vector2d(end.at + *best * end.outwards) : end.at;
}

std::vector<PlanWall> met_at_corners(const std::vector<DrawnWall>& drawn, double max_back_m) {
  LineGrid grid;
  for (std::size_t i = 0; i < drawn.size(); ++i)
    grid.insert(static_cast<int>(i), drawn[i].wall.a, drawn[i].wall.b);
  std::vector<PlanWall> walls;
  for (std::size_t i = 0; i < drawn.size(); ++i) {
    PlanWall wall = drawn[i].wall;
    const Eigen::Vector2d along = (wall.b - wall.a).normalized();
    wall.a = met({drawn[i].wall.a, -along, drawn[i].room_a_m}, drawn, grid, i, max_back_m);
    wall.b = met({drawn[i].wall.b, along, drawn[i].room_b_m}, drawn, grid, i, max_back_m);
    walls.push_back(wall);
  }
  return walls;
}

DrawnWall drawn(const WallLine& line, const Stretch& stretch) {
  const double middle = 0.5 * (stretch.from_m + stretch.to_m);
  return {{line.at(stretch.from_m), line.at(stretch.to_m), std::sqrt(covariance_at(line, middle)(1, 1)),
           stretch.views},
          stretch.room_before_m,
          stretch.room_after_m};
}

/// Whether a wall is the poorer picture of another that faces the same side.
bool is_double_of(const PlanWall& wall, const PlanWall& other, double double_m) {
  constexpr double same_side = 0.9;  // cosine
  if (wall.views >= other.views) return false;
  if ((wall.b - wall.a).normalized().dot((other.b - other.a).normalized()) < same_side) return false;
  return distance_to_segment_m(wall.a, other.a, other.b) < double_m &&
         distance_to_segment_m(wall.b, other.a, other.b) < double_m;
}

void remove_doubles(std::vector<DrawnWall>& walls, double double_m) {
  LineGrid grid;
  for (std::size_t i = 0; i < walls.size(); ++i)
    grid.insert(static_cast<int>(i), walls[i].wall.a, walls[i].wall.b);
  std::vector<bool> doubles;
  for (const DrawnWall& drawn : walls) {
    const std::vector<int> near = grid.near(drawn.wall.a, drawn.wall.b);
    doubles.push_back(std::any_of(near.begin(), near.end(), [&](int i) {
      return is_double_of(drawn.wall, walls[static_cast<std::size_t>(i)].wall, double_m);
    }));
  }
  std::size_t at = 0;
  std::erase_if(walls, [&](const DrawnWall&) { return doubles[at++]; });
}

/// An opening that no wall crosses: where one does, it is the space between two things.
bool is_clear(const PlanOpening& opening, const std::vector<PlanWall>& walls, const LineGrid& grid,
              double margin_m) {
  const Eigen::Vector2d along = (opening.b - opening.a).normalized();
  const double length = (opening.b - opening.a).norm();
  for (const int i : grid.near(opening.a, opening.b)) {
    const PlanWall& wall = walls[static_cast<std::size_t>(i)];
    const DrawnWall fixed{wall, 0, 0};
    const std::optional<double> at = reach_to_meet({opening.a, along, length - margin_m}, fixed, 0);
    if (at && *at > margin_m) return false;
  }
  return true;
}

std::vector<PlanOpening> clear_of_walls(const std::vector<PlanOpening>& openings,
                                        const std::vector<PlanWall>& walls, double margin_m) {
  LineGrid grid;
  for (std::size_t i = 0; i < walls.size(); ++i) grid.insert(static_cast<int>(i), walls[i].a, walls[i].b);
  std::vector<PlanOpening> clear;
  std::copy_if(openings.begin(), openings.end(), std::back_inserter(clear),
               [&](const PlanOpening& opening) { return is_clear(opening, walls, grid, margin_m); });
  return clear;
}

}  // namespace

VectorPlan fit_plan(const PlanSource& source, const PlanOptions& options) {
  std::vector<FittedWall> fitted = fit_walls(source.segments, options.walls);
  std::vector<WallLine> lines;
  for (FittedWall& wall : fitted) {
    wall.line.half_m += options.stretches.corner_reach_m;
    lines.push_back(wall.line);
  }
  std::vector<std::vector<int>> passes(lines.size());
  if (!source.views.empty()) passes = count_passes(lines, source.views, options.stretches);
  std::vector<DrawnWall> walls;
  std::vector<PlanOpening> openings;
  for (std::size_t i = 0; i < fitted.size(); ++i) {
    const Stretches found = stretches_of(fitted[i], source.segments, passes[i], options.stretches);
    for (const Stretch& stretch : found.walls) walls.push_back(drawn(lines[i], stretch));
    for (const Stretch& stretch : found.openings)
      openings.push_back({lines[i].at(stretch.from_m), lines[i].at(stretch.to_m)});
  }
  remove_doubles(walls, options.stretches.double_m);
  VectorPlan plan;
  plan.walls = met_at_corners(walls, options.stretches.end_reach_m);
  plan.openings = clear_of_walls(openings, plan.walls, options.stretches.end_reach_m);
  plan.poles = fit_poles(source, options.poles);
  return plan;
}

}  // namespace isthmus
