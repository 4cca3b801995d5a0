#pragma once

#include <string>
#include <vector>

#include "server/engine/engine_state.hpp"
#include "server/engine/handling.hpp"

namespace isthmus {

/// Simultaneous localisation and mapping: scans extend the map, sightings and orders change its topology
/// (Howard et al. 2006, IV).
class Mapping : public Handling {
 public:
  explicit Mapping(EngineState& state) : state_(state) {}

  DropReason take_way(Robot& robot, const OdometryEvent& event, Outcome& outcome) override;
  DropReason refusal_of_scans(const Robot& robot) const override;
  void take_scan(Robot& robot, const Scan& scan, const Pose& odom_from_robot, Outcome& outcome) override;
  DropReason take_sighting(const SightingEvent& event, const std::string& target, bool is_tag) override;
  void refuse_sighting(const SightingEvent& event, Reason reason) override;
  DropReason obey(const CommandEvent& order) override;
  DropReason take_initial_pose(Robot&, const InitialPoseEvent&) override { return DropReason::not_finished; }
  void restarted(Robot& robot) override;
  void forget_place(Robot& robot) override;
  void work(std::int64_t receive_utime) override;
  bool has_work() const override;
  bool finish_step(Outcome& outcome) override;
  std::string_view finishing() const override;
  bool maps() const override { return true; }

 private:
  /// What of finishing is next, in this order; not in snapshots, which are made of maps that go on.
  /// Sightings that wait are tried before places are searched for: what they merge is searched as one map.
  enum class FinishStage {
    scans,
    trial,
    waiting_sightings,
    searches,
    finds,
    sightings,
    proximity_matching,
    fit
  };

  const EngineOptions& options() const { return state_.configuration.engine; }
  bool stage_step(Outcome& outcome);
  void begin_stage();
  void answer_waiting_scans(Outcome& outcome);
  bool fit_next_island();
  void ask_again_what_merged();
  void keep(Robot& robot, ScanOutcome done, const Pose& odom_from_robot, Outcome& outcome);
  void relate_measured_starts();
  DropReason drop_data(const std::string& name);
  DropReason take_back_drop(const std::string& name);
  void map_changed(const std::vector<std::vector<PatchId>>& islands);
  void arrange_meeting();

  EngineState& state_;
  FinishStage finish_stage_ = FinishStage::scans;
  std::vector<std::vector<PatchId>> islands_to_fit_;
};

}  // namespace isthmus
