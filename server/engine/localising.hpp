#pragma once

#include <string>
#include <vector>

#include "server/engine/engine_state.hpp"
#include "server/engine/frozen/frozen.hpp"
#include "server/engine/handling.hpp"

namespace isthmus {

/// Localisation only: the map is finished, and whatever would change it is refused as `frozen`.
class Localising : public Handling {
 public:
  /// Robots that are on the map stay where they are on it.
  explicit Localising(EngineState& state);

  DropReason take_way(Robot& robot, const OdometryEvent& event, Outcome& outcome) override;
  DropReason refusal_of_scans(const Robot&) const override { return DropReason::none; }
  void take_scan(Robot& robot, const Scan& scan, const Pose& odom_from_robot, Outcome& outcome) override;
  DropReason take_sighting(const SightingEvent& event, const std::string& target, bool is_tag) override;
  void refuse_sighting(const SightingEvent&, Reason) override {}
  DropReason obey(const CommandEvent& order) override;
  DropReason take_initial_pose(Robot& robot, const InitialPoseEvent& event) override;
  void restarted(Robot& robot) override { frozen_.restart(robot); }
  void forget_place(Robot& robot) override { frozen_.restart(robot); }
  /// What is heard need not come after the journal: a log of another day may be localised.
  void work(std::int64_t receive_utime) override;
  bool has_work() const override { return frozen_.has_work(); }
  bool finish_step(Outcome& outcome) override;
  std::string_view finishing() const override { return "waiting scans"; }
  std::vector<LostRobot> lost_robots() const override;
  bool maps() const override { return false; }

 private:
  EngineState& state_;
  Frozen frozen_;
};

}  // namespace isthmus
