#pragma once

#include <cstdint>
#include <functional>
#include <limits>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "server/engine/frozen/finder.hpp"
#include "server/engine/frozen/given_pose.hpp"
#include "server/engine/localise/mapper.hpp"
#include "server/engine/map/credit.hpp"

namespace isthmus {

/// Localisation only: robots on a map that does not change. One that is on the map is followed over it as
/// while mapping (Howard et al. 2006, IV-A, without eq. 15). One that is new, or was carried away, or went
/// where the map does not reach, is looked for where it was last and, by what it sees on its way, all over
/// the map; until it is found, no pose is published.
///
/// Nothing of it is kept in snapshots.
class Frozen {
 public:
  Frozen(const Map& map, const EngineOptions& options) : places_(all_places(map, options)) {}

  /// Nothing where the robot is not on the map as far as is known.
  std::optional<ScanOutcome> take_scan(const Map& map, Robot& robot, Observation observation,
                                       const Pose& odom_from_robot, const EngineOptions& options);

  /// Somebody says where the robot is. Its next scans are matched there; the first that fits puts it there.
  /// Where none does, it stays what it was: found elsewhere, or lost.
  DropReason take_given(const Map& map, const Robot& robot, const InitialPoseEvent& event,
                        const FrozenOptions& options);

  /// Somebody who is found sees a robot that is not, or that one sees him or a fixed tag: it is looked for
  /// there as where it is said to be. Returns whether it is.
  bool take_sighting(const Map& map, const std::map<std::string, Robot>& robots, const SightingEvent& event,
                     const std::string& target, bool is_tag, const FrozenOptions& options);

  /// The robot's odometry begins anew, where it was or elsewhere.
  void restart(Robot& robot);

  /// Searches on, on credit that grows with time, in bounded steps.
  void advance(const Map& map, const EngineOptions& options, std::int64_t now_utime);
  bool has_work() const;

  /// Those that are not on the map for sure, by name; `is_placed`: whether scans are matched somewhere.
  std::vector<LostRobot> lost(const std::function<bool(const std::string& robot)>& is_placed,
                              const EngineOptions& options) const;

  const FinderCounts& counts() const { return counts_; }

 private:
  /// Of a robot that is not on the map for sure.
  struct Lookout {
    std::optional<Localisation> last;  ///< where it was before its odometry began anew
    Finder finder;
    int tries_left = 0;       ///< scans to be matched where it is thought to be; 0: any number
    bool moved_away = false;  ///< it may be elsewhere: where it is found, a new session begins
    bool sought = false;      ///< where it is thought to be, the finder found
  };

  /// What became of poses that were given.
  struct Given {
    std::optional<GivenPose> trial;
    NotFound why = NotFound::trying_a_place;  ///< it did not fit, at its last trial
    std::int64_t utime = 0;                   ///< of the scan of that
    /// Of the newest by a sighting.
    std::int64_t sighted_utime = std::numeric_limits<std::int64_t>::min() / 2;
    bool by_sighting = false;  ///< of which nobody need be told
  };

  static bool is_told(const Given& given) { return !given.trial && !given.by_sighting; }
  std::optional<ScanOutcome> try_given(const Map& map, Robot& robot, Given& given,
                                       const Observation& observation, const Pose& odom_from_robot,
                                       const EngineOptions& options);
  void put_where_thought(Robot& robot, Lookout& lookout, std::int64_t utime, const Pose& odom_from_robot,
                         const FrozenOptions& options);
  std::optional<ScanOutcome> follow_on(const Map& map, Robot& robot, const Observation& observation,
                                       const Pose& odom_from_robot, const EngineOptions& options);
  void lose(Robot& robot, Lookout& lookout, const Expectation& expectation, const FrozenOptions& options);

  std::vector<RigidPiece> places_;
  std::map<std::string, Lookout> lookouts_;  ///< by robot
  std::map<std::string, Given> given_;       ///< by robot
  std::string searched_last_;
  FinderCounts counts_;
  Credit credit_;
};

}  // namespace isthmus
