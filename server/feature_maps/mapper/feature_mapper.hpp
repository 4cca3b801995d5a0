#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include "server/engine/robot/robot_pose.hpp"
#include "server/engine/sightings/sighting_log.hpp"
#include "server/engine/sightings/tag_record.hpp"
#include "server/feature_maps/mapper/journey.hpp"
#include "server/feature_maps/mapper/map_input.hpp"
#include "server/feature_maps/mapper/team.hpp"
#include "server/feature_maps/meeting/fusion_record.hpp"
#include "server/feature_maps/meeting/open_meeting.hpp"
#include "server/feature_maps/meeting/placement.hpp"
#include "server/feature_maps/merging/map_sketch.hpp"

namespace isthmus {

/// What became of a sighting.
struct FeatureSighting {
  SightingEvent sighting;
  bool used = false;
  std::string reason;        ///< why not; empty where it was
  std::int32_t fusion = -1;  ///< that it speaks for or against; -1: none

  auto members() { return std::tie(sighting, used, reason, fusion); }
};

struct FeatureCounts {
  std::int64_t events = 0;
  std::int64_t scans = 0;
  std::int64_t scans_used = 0;
  std::int64_t scans_tracked = 0;  ///< of these, placed on those before them
  std::int64_t segments_seen = 0;
  std::int64_t segments_paired = 0;
  std::int64_t contradicted = 0;  ///< features that went because scans see through them
  std::int64_t fusions = 0;
  std::int64_t withdrawn = 0;  ///< fusions that later sightings spoke against, and that were taken back
  std::map<std::string, std::int64_t> dropped;  ///< events, by reason
  std::int64_t first_receive_utime = 0;
  std::int64_t last_receive_utime = 0;

  auto members() {
    return std::tie(events, scans, scans_used, scans_tracked, segments_seen, segments_paired, contradicted,
                    fusions, withdrawn, dropped, first_receive_utime, last_receive_utime);
  }
};

/// What there is of maps: for outputs.
struct FeatureMaps {
  FeatureMapKind kind = FeatureMapKind::segments;
  std::vector<Team> teams;  ///< by number of features, most first
  std::vector<Journey> journeys;
  std::vector<FeatureSighting> sightings;
  std::vector<FusionRecord> fusions;  ///< by id
  FeatureCounts counts;
};

/// Maps of features from the engine's own events: an estimator beside it. Each robot begins a map of its own;
/// two become one where sightings and what they have in common make that probable enough (consider), or where
/// they know the same landmarks. The same events give the same maps. Bad input is counted and changes
/// nothing.
///
/// Events become inputs once odometry has placed them; maps are made of inputs alone, so that they can be
/// made again without a fusion (FeatureEstimator).
class FeatureMapper {
 public:
  explicit FeatureMapper(const FeatureMapOptions& options);

  void handle(const Event& event);
  void take(const RobotEvent& event);
  /// What still waits for odometry is done without it.
  void finish();

  /// One input; those of a robot in their order.
  void apply(const MapInput& input);
  /// What became inputs, and was applied, since the last call.
  std::vector<MapInput> take_inputs() { return std::exchange(inputs_, {}); }
  /// Where each robot's odometry is, what waits for it, and what was counted before anything was an input: of
  /// a mapper that took the same events.
  void continue_from(FeatureMapper& other);
  /// Fusions that must not be made; before the first input.
  void forbid(std::set<std::int32_t> fusions) { forbidden_ = std::move(fusions); }
  /// Of a fusion that was made and is contradicted by now: it should be taken back.
  std::optional<std::int32_t> contradicted_fusion() const { return contradicted_; }
  std::optional<FusionState> state_of_fusion(std::int32_t id) const;
  /// Where robots are by what was applied since the last call: what odometry alone placed is not matched.
  std::vector<RobotPose> take_answers();

  bool knows(const std::string& robot) const { return robots_.contains(robot); }
  std::vector<std::string> robot_names() const;
  bool has_waiting() const;
  /// Fixed barcodes, with where those that were seen are.
  std::vector<TagRecord> tag_records() const;
  void count_dropped(const std::string& reason) { ++counts_.dropped[reason]; }

  FeatureMaps maps() const;
  /// The same without states, ways and sightings: does not grow with the map, nor with time.
  FeatureMaps summary() const;
  /// What became of each sighting, as records tell it.
  const SightingLog& told() const { return told_; }

  /// For snapshots (feature_snapshot.cpp): options are those of whoever restores it, and are taken on by
  /// `keep_options`.
  auto members() {
    return std::tie(options_, robots_, wearers_, tags_, teams_, journeys_, sightings_, told_, last_used_,
                    first_seen_, heard_, encounters_, encounter_count_, fusions_, open_, forbidden_,
                    contradicted_, inputs_, moved_, next_number_, next_scan_, asked_, counts_);
  }
  void keep_options();
  /// Whether what names something names what there is.
  bool is_sound() const;

 private:
  struct Encounter {
    int number = 0;
    std::int64_t begun_utime = 0;

    auto members() { return std::tie(number, begun_utime); }
  };

  void take(const OdometryEvent& event);
  void wait(const std::string& robot, const Event& event);
  void take_waiting(FeatureRobot& robot, std::int64_t now_utime, bool all);
  void record(MapInput input);
  void take_placed(FeatureRobot& robot, const Event& event, const Pose& odom_from_robot);
  void declare(const RobotEvent& event);
  void begin_journey(FeatureRobot& robot, const Pose& odom_from_robot);
  void note_way(FeatureRobot& robot, const Pose& odom_from_robot);
  void move_by_odometry(FeatureRobot& robot);
  void move_by_scan(FeatureRobot& robot, const Scan& scan);
  OdometryPath pose_of(const FeatureRobot& robot) const;
  bool observe(FeatureRobot& robot, const Scan& scan, std::int64_t utime);
  void stop(FeatureRobot& robot, std::int64_t utime, std::vector<FeatureView> views,
            std::vector<RobotView> robots = {});
  bool keep_view(const FeatureRobot& robot, const Scan& scan);
  std::string use(FeatureRobot& robot, const MapInput& input);
  std::string use_landmark(FeatureRobot& robot, const MapInput& input);
  std::string use_robot(FeatureRobot& robot, const MapInput& input, FeatureRobot& target);
  std::string use_on_one_map(const MapInput& input, FeatureRobot& robot, FeatureRobot& target);
  std::string hear(const MapInput& input, int observer, int target, const FeatureRobot& seen);
  int encounter_of(int one, int two, std::int64_t utime);
  void consider(int one, int two);
  void forget_waiting(std::int32_t fusion);
  void lay_over_others(int grown, const MapInput& input);
  bool may_tell_more(int one, int two);
  bool have_grown(std::size_t views_then, std::size_t views) const;
  bool merge_by_walls(int one, int two, const MapInput& input);
  FusionRecord& record_of_placing(int one, int two, const Pose& one_from_two, const Eigen::Vector2d& middle,
                                  const MapInput& input);
  void forget_waiting_by_walls(int one, int two, std::int32_t but);
  double clues_log_odds(std::span<const Heard> heard, const Pose& one_from_two,
                        std::set<std::size_t>& agreeing) const;
  MapSketch sketch(const Team& team) const;
  std::size_t views_of(int team) const;
  int first_with_views(const Team& team) const;
  std::vector<Heard> heard_between(int one, int two) const;
  std::vector<Heard> tags_between(int one, int two) const;
  void fuse_at(int one, int two, const std::vector<Heard>& heard, const MapPlacement& placement,
               FusionRecord& record);
  void accept(int one, int two, const JoinedTeams& joined, const std::set<std::size_t>& agreeing,
              FusionRecord& record);
  void keep_open(int one, int two, int member_1, int member_2, const RobotAlignment& alignment,
                 std::int32_t fusion);
  void close_meeting(int one, int two);
  void hand_over_meetings(int one, int two, int ids);
  void take_up_meetings(int grown);
  bool is_known(const RobotEvent& event) const;
  void close_account(int one, int two, const std::set<std::size_t>& agreeing, std::int32_t fusion);
  void judge_fusion(int observer, int target, const LinearMeasurement& measured,
                    const SightingEvent& sighting);
  void join_by_landmarks();
  void join(int one, int two, const JoinedTeams& joined);
  void add_row(const FeatureRobot& robot, std::int64_t utime);
  void tell(std::size_t sighting);
  Journey& journey(const FeatureRobot& robot) { return journeys_[static_cast<std::size_t>(robot.journey)]; }
  const Journey& journey(const FeatureRobot& robot) const {
    return journeys_[static_cast<std::size_t>(robot.journey)];
  }
  Team& team_of(const Journey& journey) { return teams_[static_cast<std::size_t>(journey.team)]; }

  FeatureMapOptions options_;
  std::map<std::string, FeatureRobot> robots_;
  std::map<std::int32_t, std::string> wearers_;
  std::set<std::int32_t> tags_;
  std::vector<Team> teams_;  ///< those that were joined to others have no robots
  std::vector<Journey> journeys_;
  std::vector<FeatureSighting> sightings_;
  SightingLog told_;                                                        ///< the same, shared with copies
  std::map<std::pair<std::string, std::int32_t>, std::int64_t> last_used_;  ///< by observer and barcode
  std::map<std::pair<int, std::int32_t>, std::int32_t> first_seen_;         ///< input, by journey and barcode
  std::vector<Heard> heard_;                             ///< between maps, as long as they are two
  std::map<std::pair<int, int>, Encounter> encounters_;  ///< the last, by journeys
  int encounter_count_ = 0;
  std::map<std::int32_t, FusionRecord> fusions_;
  std::map<std::pair<int, int>, OpenMeeting> open_;  ///< the last, by maps
  std::set<std::int32_t> forbidden_;
  std::optional<std::int32_t> contradicted_;
  std::vector<MapInput> inputs_;
  std::set<std::string> moved_;  ///< robots with rows since answers were taken
  std::int32_t next_number_ = 0;
  std::int32_t next_scan_ = 0;
  std::map<std::pair<int, int>, std::size_t> asked_;  ///< views of two maps when they were last laid over one
                                                      ///< another, by teams
  FeatureCounts counts_;
};

}  // namespace isthmus
