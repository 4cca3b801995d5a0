#pragma once

#include <cstdint>
#include <limits>
#include <numbers>
#include <string>
#include <variant>
#include <vector>

#include "patches/scan.hpp"
#include "tools/simulate/plan/floor_plan.hpp"

namespace isthmus {

/// A laser range finder and what is wrong with it. Defaults: Benedettelli et al. 2012, section 5.1.
struct LaserPlan {
  int beams = 181;
  double field_of_view_rad = std::numbers::pi;
  double rate_hz = 5;               ///< 0: the robot has no laser
  Laser laser = {Pose{}, 0.05, 8};  ///< as it is; a hit at or beyond range_max_m is a no-return
  Pose declared_mount_error;        ///< declared mount = true mount * this
  double range_sigma_m = 0.003;
  double bearing_sigma_rad = 0.003;                ///< of each beam on its own
  double dropout_share = 0.002;                    ///< beams that report 0
  double no_return_share = 0;                      ///< beams that do not come back, whatever they meet
  bool interlaced = false;                         ///< every other scan looks half a step aside
  double return_limit_rad = std::numbers::pi / 2;  ///< beams farther off a wall's normal do not come back
  bool no_return_is_infinite = true;               ///< else the maximum range is reported
  double scan_lag_s = 0;  ///< a scan was taken this long before its stamp (and its odometry)
};

/// Wheel odometry. Noise: Benedettelli et al. 2012, eqs. 27-29: independent every noise_period_s, while the
/// robot moves, with sigma_v = linear_share |v| and sigma_omega = angular_share |omega| + angular_floor.
struct OdometryPlan {
  double rate_hz = 20;
  double linear_share = 0.03;
  double angular_share = 0.05;
  double angular_floor_rps = 0.0017;
  double noise_period_s = 0.2;
  double linear_scale = 1;  ///< distance reported for a metre driven; 0: none, 1000: in millimetres
  double angular_scale = 1;
  double linear_scale_sigma = 0;  ///< drawn once for each robot and run, added to the scale
  double angular_scale_sigma = 0;
  double curvature_rpm = 0;  ///< yaw reported for each metre driven straight ahead
};

/// A sensor that reads barcodes of robots and tags. Defaults: Benedettelli et al. 2012.
struct CameraPlan {
  double rate_hz = 2;  ///< 0: the robot has no camera
  double from_s = 0;   ///< time of the run; it reads nothing before
  double range_max_m = 8;
  double field_of_view_rad = 2 * std::numbers::pi;  ///< about the robot's x axis
  double range_sigma_m = 0.02;
  double bearing_sigma_rad = 0.07;
  double detection_share = 0.9;  ///< of barcodes in sight
};

struct DrivePlan {
  double speed_mps = 0.5;
  double acceleration_mps2 = 0.5;
  double turn_rate_rps = 0.8;
  double lookahead_m = 0.5;
  double waypoint_jitter_m = 0.05;  ///< sigma: no two laps follow the same line
};

struct Waypoint {
  Eigen::Vector2d position;
  double clearance_m = std::numeric_limits<double>::infinity();  ///< of the legs that meet here
};
struct Wait {
  double seconds = 0;
};
/// It turns on the spot.
struct Turn {
  double angle_rad = 0;  ///< counter-clockwise; may be several times round
};
/// Somebody carries the robot away: it is silent on the way, and its odometry goes on from where it was or
/// restarts at zero.
struct Carry {
  Pose world_from_robot;
  double seconds = 15;
  bool odometry_restarts = true;
  bool announced = false;  ///< the robot says that it restarted
};
using TourStep = std::variant<Waypoint, Wait, Turn, Carry>;

/// Odometry repeats itself from one time of the run to another, then jumps to where it should be.
struct Freeze {
  double from_s = 0;
  double to_s = 0;
};

struct RobotPlan {
  std::string name;  ///< upper case
  int barcode = -1;
  double radius_m = 0.22;
  Pose start;          ///< world_from_robot
  double start_s = 0;  ///< it is not there before
  int laps = 1;
  bool silent = false;         ///< somebody who walks there: others see it, and it sends nothing
  std::vector<TourStep> tour;  ///< driven `laps` times
  std::vector<Freeze> freezes;
  DrivePlan drive;
  LaserPlan laser;
  OdometryPlan odometry;
  CameraPlan camera;
};

struct TagPlan {
  int barcode = -1;
  Eigen::Vector2d position;
};

/// What the building is like from some time of the run on.
struct BuildingChange {
  double from_s = 0;
  FloorPlan plan;
};

/// What is simulated: data, read from a TOML file.
struct Scenario {
  std::string name;
  std::string summary;
  std::int64_t start_utime = 1'700'000'000'000'000;
  double duration_s = 0;         ///< 0: until every tour is done
  bool bodies_visible = false;   ///< lasers see other robots
  bool robots_give_way = false;  ///< they wait for one another; else they drive as if alone
  double false_sightings = 0;    ///< share of all sightings
  FloorPlan plan;
  std::vector<BuildingChange> changes;  ///< in order of time; robots keep clear of every plan at all times
  std::vector<RobotPlan> robots;
  std::vector<TagPlan> tags;
};

}  // namespace isthmus
