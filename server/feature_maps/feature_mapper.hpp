#pragma once

#include <cstdint>
#include <map>
#include <set>
#include <string>
#include <vector>

#include "server/feature_maps/journey.hpp"
#include "server/feature_maps/team.hpp"

namespace isthmus {

/// What became of a sighting.
struct FeatureSighting {
  SightingEvent sighting;
  bool used = false;
  std::string reason;  ///< why not; empty where it was
};

struct FeatureCounts {
  std::int64_t events = 0;
  std::int64_t scans = 0;
  std::int64_t scans_used = 0;
  std::int64_t segments_seen = 0;
  std::int64_t segments_paired = 0;
  std::int64_t slips = 0;         ///< scans that fit the map only where wheels had slipped
  std::int64_t contradicted = 0;  ///< features that went because scans see through them
  std::int64_t fusions = 0;
  std::int64_t fusions_waiting = 0;             ///< meetings that nothing else bore out
  std::map<std::string, std::int64_t> dropped;  ///< events, by reason
  std::int64_t first_receive_utime = 0;
  std::int64_t last_receive_utime = 0;
};

/// What there is of maps: for outputs.
struct FeatureMaps {
  FeatureMapKind kind = FeatureMapKind::segments;
  std::vector<Team> teams;  ///< by number of features, most first
  std::vector<Journey> journeys;
  std::vector<FeatureSighting> sightings;
  FeatureCounts counts;
};

/// Maps of features from the engine's own events: an estimator beside it. Each robot begins a map of its own;
/// two become one where the robots see one another and the maps bear it out, or where they know the same
/// landmarks. The same events give the same maps. Bad input is counted and changes nothing.
class FeatureMapper {
 public:
  explicit FeatureMapper(const FeatureMapOptions& options);

  void handle(const Event& event);
  /// What still waits for odometry is done without it.
  void finish();
  void count_dropped(const std::string& reason) { ++counts_.dropped[reason]; }

  FeatureMaps maps() const;

 private:
  /// That two robots saw one another, each once.
  struct Meeting {
    SightingEvent first;
    SightingEvent second;  ///< the later one
    int journey_1 = 0;
    int journey_2 = 0;
  };

  void take(const RobotEvent& event);
  void take(const OdometryEvent& event);
  void wait(const std::string& robot, const Event& event);
  void take_waiting(FeatureRobot& robot, std::int64_t now_utime, bool all);
  void take_placed(FeatureRobot& robot, const Event& event, const Pose& odom_from_robot);
  void move_to(FeatureRobot& robot, const Pose& odom_from_robot);
  void begin_journey(FeatureRobot& robot, const Pose& odom_from_robot);
  void observe(FeatureRobot& robot, const Scan& scan);
  FeatureScanOutcome observe_or_slip(FeatureFilter& filter, int member,
                                     std::span<const ObservedFeature> seen);
  std::string use(FeatureRobot& robot, const SightingEvent& sighting);
  std::string use_landmark(const FeatureRobot& robot, const SightingEvent& sighting);
  std::string use_robot(const FeatureRobot& robot, const SightingEvent& sighting, const FeatureRobot& target);
  std::string meet(const Meeting& meeting);
  bool borne_out(const Meeting& meeting, const RobotAlignment& alignment);
  void join_by_landmarks();
  void join(int one, int two, const JoinedTeams& joined);
  void add_row(const FeatureRobot& robot, std::int64_t utime);
  Journey& journey(const FeatureRobot& robot) { return journeys_[static_cast<std::size_t>(robot.journey)]; }
  const Journey& journey(const FeatureRobot& robot) const {
    return journeys_[static_cast<std::size_t>(robot.journey)];
  }
  Team& team_of(const Journey& journey) { return teams_[static_cast<std::size_t>(journey.team)]; }

  /// A meeting that waits for another: where it puts the second map in the first.
  struct Pending {
    int team_1 = 0;
    int team_2 = 0;
    Pose one_from_two;
    double heading_sigma_rad = 0;
    double range_sigma_m = 0;
  };

  FeatureMapOptions options_;
  double gate_ = 0;
  std::map<std::string, FeatureRobot> robots_;
  std::map<std::int32_t, std::string> wearers_;
  std::set<std::int32_t> tags_;
  std::vector<Team> teams_;  ///< those that were joined to others have no robots
  std::vector<Journey> journeys_;
  std::vector<FeatureSighting> sightings_;
  std::map<std::pair<std::string, std::int32_t>, std::int64_t> last_used_;  ///< by observer and barcode
  std::vector<Pending> pending_;
  std::map<std::pair<std::string, std::string>, SightingEvent> one_way_;  ///< last, by observer and target
  FeatureCounts counts_;
};

}  // namespace isthmus
