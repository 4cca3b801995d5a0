#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <numbers>
#include <vector>

namespace isthmus {

/// A gap in a wall: the distance of its middle along the wall from the wall's first point, and its width.
struct Door {
  double along_m = 0;
  double width_m = 0.9;
};

/// A wall along a polyline of corners.
struct Wall {
  std::vector<Eigen::Vector2d> corners;
  bool closed = false;
  std::vector<Door> doors;
};

/// A building as a person describes it; world frame, metres.
struct Building {
  std::vector<Wall> walls;
  std::vector<std::vector<Eigen::Vector2d>> furniture;  ///< closed polygons
  double wall_thickness_m = 0.12;                       ///< 0: walls are lines
  double roughness_m = 0;  ///< sigma of the walls' departures from straight, a knot each `facet_m`
  double facet_m = 0.6;
  double glossy_share = 0;                                    ///< of walls, which give no return at a slant
  double glossy_incidence_rad = 65 * std::numbers::pi / 180;  ///< from the wall's normal
  std::uint64_t seed = 1;  ///< for roughness and gloss: a building is the same in every run
};

/// A piece of surface that stops light and robots.
struct Segment {
  Eigen::Vector2d a;
  Eigen::Vector2d b;
  double return_limit_rad = std::numbers::pi;  ///< beams farther than this off the normal do not come back
};

/// What lasers and robots meet: every surface of a building.
struct FloorPlan {
  std::vector<Segment> segments;
  Eigen::Vector2d low = Eigen::Vector2d::Zero();  ///< bounding box
  Eigen::Vector2d high = Eigen::Vector2d::Zero();
};

FloorPlan build_floor_plan(const Building& building);

double distance_m(const Eigen::Vector2d& point, const Segment& segment);
/// The shortest distance between two segments, 0 where they cross.
double distance_m(const Segment& a, const Segment& b);
/// The distance of a straight line from the nearest surface; infinity in an empty plan.
double clearance_m(const FloorPlan& plan, const Eigen::Vector2d& from, const Eigen::Vector2d& to);

}  // namespace isthmus
