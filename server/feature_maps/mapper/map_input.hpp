#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <tuple>

#include "server/engine/input/event.hpp"

namespace isthmus {

enum class MapInputKind : std::uint8_t {
  declared,  ///< a robot says what it is; a restart begins another journey
  tag,       ///< a barcode is fixed in the building
  begun,     ///< a robot is heard of for the first time
  moved,     ///< its pose is a row of its way; so it is with the two that follow
  scanned,   ///< what it sees is used
  sighted    ///< a barcode
};

/// What maps are made of, in the order in which they are: an event that odometry has placed. The same inputs
/// give the same maps, so that maps can be made again without what turned out wrong. Scans that are not used
/// are not among them, nor odometry between what is placed: they grow with the way driven, and slowly with
/// time.
struct MapInput {
  MapInputKind kind = MapInputKind::moved;
  std::int32_t number = -1;  ///< of sightings, and of scans, rising: names a fusion that it is the first to
                             ///< speak for
  std::string robot;
  Pose odom_from_robot;
  std::int64_t utime = 0;                ///< the sender's stamp
  std::shared_ptr<const Event> event;    ///< declared, tag, scanned, sighted
  std::optional<Pose> odom_from_target;  ///< sighted: odometry of the robot seen, at the stamp or nearest it
  double target_late_s = 0;              ///< how far from the stamp that is

  /// Whether it holds the event that its kind says.
  bool is_sound() const;

  auto members() {
    return std::tie(kind, number, robot, odom_from_robot, utime, event, odom_from_target, target_late_s);
  }
};

/// s from one stamp to another.
inline double seconds_between(std::int64_t from_utime, std::int64_t to_utime) {
  return 1e-6 * (static_cast<double>(to_utime) - static_cast<double>(from_utime));
}

}  // namespace isthmus
