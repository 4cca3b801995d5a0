#pragma once

#include <cstdint>
#include <string>
#include <tuple>
#include <variant>
#include <vector>

#include "patches/ids.hpp"
#include "patches/scan.hpp"
#include "server/engine/input/annotation_kind.hpp"
#include "server/engine/input/verb.hpp"

namespace isthmus {

/// The engine's input. The wire makes events of messages that it has checked; the journal keeps the
/// messages; the engine is a function from a sequence of events to a map. Times in microseconds; `utime` is
/// the sender's stamp. Robot names are upper case.

struct ConfigurationEvent {
  std::string toml;  ///< the text of the configuration file; always the first event of a journal
};

struct RobotEvent {
  std::string robot;
  std::int64_t utime = 0;
  std::int32_t barcode = -1;  ///< the barcode it wears; negative: none
  Laser laser;
  double footprint_radius_m = 0.25;
  bool restarted = false;  ///< the robot says that it begins a new session

  auto members() { return std::tie(robot, utime, barcode, laser, footprint_radius_m, restarted); }
};

struct TagEvent {
  std::int64_t utime = 0;
  std::int32_t barcode = -1;

  auto members() { return std::tie(utime, barcode); }
};

struct OdometryEvent {
  std::string robot;
  std::int64_t utime = 0;
  Pose odom_from_robot;
};

struct ScanEvent {
  std::string robot;
  Scan scan;

  auto members() { return std::tie(robot, scan); }
};

/// From the observer's base origin to the target's; a sigma of +infinity: that part was not measured.
struct SightingEvent {
  std::string robot;  ///< the observer
  std::int64_t utime = 0;
  std::int32_t barcode = -1;
  double range_m = 0;
  double range_sigma_m = 0;
  double bearing_rad = 0;
  double bearing_sigma_rad = 0;

  auto members() {
    return std::tie(robot, utime, barcode, range_m, range_sigma_m, bearing_rad, bearing_sigma_rad);
  }
};

struct CommandEvent {
  std::int64_t utime = 0;
  Verb verb = Verb::send_map;
  std::int64_t closure = -1;
  std::string robot;
};

/// An operator names a place, draws a zone, or takes one of them away.
struct AnnotationEvent {
  std::int64_t utime = 0;
  AnnotationKind kind = AnnotationKind::place;
  std::string name;
  bool replace = false;      ///< takes the place of the one that has this name, if any
  double max_speed_m_s = 0;  ///< of a speed zone
  double yaw_rad = 0;        ///< of a place, in the frame of its point
  IslandId island;           ///< whose plane the points are in; none: each is in its patch's frame
  struct Point {
    PatchId patch;
    Eigen::Vector2d position = Eigen::Vector2d::Zero();  ///< m
  };
  std::vector<Point> points;
};

/// Somebody says where a robot is on a finished map.
struct InitialPoseEvent {
  std::string robot;
  std::int64_t utime = 0;
  IslandId island;  ///< whose plane the pose is in; none: it is in the frame of the patch
  PatchId patch;
  Pose pose;
  double sigma_m = 0;    ///< of x and of y
  double sigma_rad = 0;  ///< of the yaw
};

/// Time passes while the robots are silent.
struct TickEvent {};

struct Event {
  std::int64_t receive_utime = 0;  ///< the journal's time: the LCM log header
  std::variant<ConfigurationEvent, RobotEvent, TagEvent, OdometryEvent, ScanEvent, SightingEvent,
               CommandEvent, TickEvent, AnnotationEvent, InitialPoseEvent>
      body;
};

}  // namespace isthmus
