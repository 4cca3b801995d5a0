#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "server/engine/frozen/lost_robot.hpp"
#include "server/engine/input/drop_reason.hpp"
#include "server/engine/input/event.hpp"
#include "server/engine/map/reason.hpp"
#include "server/engine/outcome.hpp"
#include "server/engine/robot/robot.hpp"

namespace isthmus {

/// What the engine makes of what declared robots and operators send: a map (Mapping), or only where on a
/// finished map the robots are (Localising). What is the same for both, from who is known to which stamps are
/// taken, is EngineState's.
class Handling {
 public:
  virtual ~Handling() = default;

  /// Odometry of a robot without a laser. Returns why it is dropped; answers are added.
  virtual DropReason take_way(Robot& robot, const OdometryEvent& event, Outcome& outcome) = 0;
  /// Why scans of the robot are dropped at present.
  virtual DropReason refusal_of_scans(const Robot& robot) const = 0;
  /// A scan with the odometry of its stamp.
  virtual void take_scan(Robot& robot, const Scan& scan, const Pose& odom_from_robot, Outcome& outcome) = 0;
  /// A sighting of a robot or tag. Returns why it is dropped.
  virtual DropReason take_sighting(const SightingEvent& event, const std::string& target, bool is_tag) = 0;
  /// A sighting of nobody known, or by nobody known.
  virtual void refuse_sighting(const SightingEvent& event, Reason reason) = 0;
  /// An order that may change the map. Returns why it is not carried out.
  virtual DropReason obey(const CommandEvent& order) = 0;

  /// Somebody says where the robot is. Returns why nobody looks there.
  virtual DropReason take_initial_pose(Robot& robot, const InitialPoseEvent& event) = 0;

  /// The robot was switched off and on.
  virtual void restarted(Robot& robot) = 0;
  /// Its odometry begins anew: nothing tells any longer where it is.
  virtual void forget_place(Robot& robot) = 0;

  /// What an event brings on beside the scans it answers.
  virtual void work(std::int64_t receive_utime) = 0;
  virtual bool has_work() const = 0;

  /// See the engine's.
  virtual bool finish_step(Outcome& outcome) = 0;
  virtual std::string_view finishing() const = 0;

  /// Robots that it cannot place.
  virtual std::vector<LostRobot> lost_robots() const { return {}; }

  /// Whether the map may change.
  virtual bool maps() const = 0;
};

}  // namespace isthmus
