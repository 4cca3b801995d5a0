#pragma once

#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#include "server/engine/input/event.hpp"
#include "server/engine/record/map_copy.hpp"
#include "server/engine/robot/robot_pose.hpp"
#include "server/exploration/expedition.hpp"
#include "server/wire/goals/team_goals.hpp"
#include "server/wire/message/server_configuration.hpp"

namespace isthmus {

/// Sends a message; called from another thread, and must not throw.
using SendGoal = std::function<void(const std::string& channel, const std::vector<std::uint8_t>& bytes)>;

/// Shows what a team was told; called from another thread, and must not throw.
using ShowGoals = std::function<void(TeamGoals)>;

struct GoalLimits {
  std::chrono::seconds silent{
      30};             ///< a robot that has not been heard for so long explores no more until it is
  int time_share = 2;  ///< at most one in so many seconds goes into goals
};

/// Tells the robots of a team where to explore, on <ROBOT>_GOAL, in a thread of its own and of lower
/// priority, from copies of the map: the engine never waits for it, and nothing of it is journalled. All: any
/// thread.
class GoalPublisher {
 public:
  /// `show`: empty: nobody looks.
  GoalPublisher(SendGoal send, const ExplorationConfiguration& configuration, ShowGoals show = {},
                GoalLimits limits = {});

  /// The newest map, of an event time in microseconds; goals are made of it and of where robots are now,
  /// which must be on it.
  void offer(std::shared_ptr<const MapCopy> map, std::int64_t utime);
  void note(const RobotPose& pose);
  void note_radius(const std::string& robot, double radius_m);

 private:
  using Clock = std::chrono::steady_clock;
  struct Robot {
    ManifoldPose pose;
    std::int64_t utime = 0;
    Clock::time_point heard;
  };
  struct Work {
    std::shared_ptr<const MapCopy> map;
    std::int64_t utime = 0;
    std::map<std::string, ExpeditionMember> team;
    std::map<std::string, std::int64_t> pose_utimes;
  };

  void loop(const std::stop_token& stop);
  void add_team(Work& work) const;
  void tell(const Work& work);

  SendGoal send_;
  ShowGoals show_;
  ExplorationConfiguration configuration_;
  GoalLimits limits_;
  Planner planner_;        ///< the thread's own
  Expedition expedition_;  ///< the thread's own

  std::mutex mutex_;
  std::condition_variable_any offered_;
  Work offer_;
  std::map<std::string, Robot> robots_;
  std::map<std::string, double> radii_m_;
  std::jthread thread_;  ///< last: it uses all above
};

}  // namespace isthmus
