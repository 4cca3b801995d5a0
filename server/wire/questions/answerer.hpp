#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <string>

#include "isthmus/reply_t.hpp"
#include "server/engine/record/map_copy.hpp"
#include "server/engine/robot/robot_pose.hpp"
#include "server/paths/questions/driven_ways.hpp"
#include "server/paths/questions/planner.hpp"
#include "server/wire/questions/map_versions.hpp"
#include "server/wire/questions/question.hpp"

namespace isthmus {

/// Where robots were last, by name.
using RobotPoses = std::map<std::string, RobotPose>;

/// Answers questions over a copy of the map: a function of that copy and of where robots are. Bounded work;
/// no clock. One thread.
class Answerer {
 public:
  /// Of a path; longer ones are refused (`too_long`).
  static constexpr std::size_t max_poses = 10'000;
  /// Those of less gain are left out of an answer.
  static constexpr std::size_t max_frontiers = 200;

  /// The map that is asked from now on, of an event time in microseconds.
  void update(std::shared_ptr<const MapCopy> map, std::int64_t utime);

  /// Of a path that was told, and is followed: another where the map, or its target, has changed it, with the
  /// change in it; nothing while it holds. Whoever asked and was told nothing may be told now.
  std::optional<reply_t> update_of(const Question& question, const reply_t& told, const RobotPoses& robots,
                                   const RobotPoses& robots_before);

  /// Without the server's clock in it. `robots`: a pose on a patch that the copy does not have yet is passed
  /// over for that of `robots_before`, of the time of the copy.
  reply_t answer(const Question& question, const RobotPoses& robots, const RobotPoses& robots_before);

 private:
  struct Asked;

  reply_t empty_reply(const Question& question) const;
  Path find_path(const Question& question, const Asked& asked, reply_t& reply);
  Refusal fill(const Question& question, const Asked& asked, reply_t& reply);
  Refusal fill_relative_pose(const Question& question, const Asked& asked, reply_t& reply) const;
  Refusal fill_frontiers(const Question& question, const Asked& asked, reply_t& reply);
  Refusal fill_changes(const Question& question, reply_t& reply) const;
  Refusal add_poses(const Path& path, reply_t& reply) const;

  Planner planner_;
  DrivenWays ways_;
  MapVersions versions_;
};

/// The reply to a request, as long as nobody has looked at it: neither done nor refused.
reply_t reply_to(const request_t& request);

}  // namespace isthmus
