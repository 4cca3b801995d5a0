#pragma once

#include <cstdint>
#include <optional>

#include "server/engine/frozen/given_pose.hpp"
#include "server/engine/robot/robot.hpp"

namespace isthmus {

/// Whether a robot is on a finished map for sure.
bool is_found(const Robot& robot);

/// Where a robot that is found was at a stamp, by its odometry since; nothing where that does not tell.
std::optional<ManifoldPose> place_at(const Robot& robot, std::int64_t utime);

/// Where a fixed tag is; nothing where it is not on the map.
std::optional<ManifoldPose> place_of_tag(const Map& map, std::int32_t barcode);

/// Where a robot is that sees something whose place is known: on a circle about it, looking so that it is
/// seen under that bearing. Nothing without range and bearing, or off the map.
std::optional<GivenPose> where_it_sees(const SightingEvent& event, const std::optional<ManifoldPose>& target,
                                       const Map& map, const FrozenOptions& options);

/// Where a robot is that is seen from a place that is known: there, looking anywhere.
std::optional<GivenPose> where_it_is_seen(const SightingEvent& event,
                                          const std::optional<ManifoldPose>& observer, const Map& map,
                                          const FrozenOptions& options);

}  // namespace isthmus
