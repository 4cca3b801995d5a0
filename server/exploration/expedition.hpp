#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "server/engine/input/words.hpp"
#include "server/engine/rendezvous/meeting_record.hpp"
#include "server/exploration/coordinator.hpp"
#include "server/exploration/explore.hpp"

namespace isthmus {

struct ExpeditionOptions {
  ExplorationOptions exploration;
  CoordinationOptions coordination;
  double share_period_s = 4;  ///< frontiers are shared out anew, and as soon as a robot has no goal
  double arrival_m = 0.45;    ///< a robot so near to its goal,
  double arrival_rad = 0.45;  ///< and that looks its way, has come to it
  double moved_m = 0.3;       ///< less is not getting on
  double give_up_s = 18;      ///< a robot that may go on and does not for so long gives its goal up
  int first_turns = 3;        ///< by which a robot looks around that sees no frontier from where it begins
  double defer_s = 15;        ///< one that has to wait for others so long is given another goal for a while
  double meet_s = 60;         ///< so long a robot stands at a meeting that settles nothing
};

/// Why a robot is told to drive.
enum class OrderReason : std::uint8_t { frontier, wait, give_way, finished, meet };
template <>
inline constexpr auto words_of<OrderReason> = std::to_array<std::string_view>({"frontier", "wait", "give_way",
                                                                               "finished", "meet"});

/// What a robot shall do now.
struct ExplorationOrder {
  OrderReason reason = OrderReason::finished;
  std::optional<ExplorationGoal> goal;  ///< none: finished
  std::int64_t number = 0;              ///< of the goal: each is another's, and grows; 0: none yet
  std::vector<ManifoldPose> path;       ///< that it drives now; at its end it stops. Empty: it stays
  bool is_last = false;                 ///< the path ends at the goal, and the robot turns as that does
};

/// A robot as it is known to be.
struct ExpeditionMember {
  ManifoldPose pose;
  Footprint footprint;
};

/// What became of goals.
struct ExpeditionCounts {
  std::size_t goals = 0;
  std::size_t given_up = 0;
  std::size_t gave_way = 0;  ///< times that a robot began to
  std::size_t meetings = 0;  ///< to which two robots were sent
};

/// A team that explores, and meets where settling whether two islands are one is worth more than new ground:
/// who goes where, who waits for whom, when a goal is reached or given up. What robots do is seen by their
/// poses alone. One thread; a function of what it was told, in order.
class Expedition {
 public:
  explicit Expedition(const ExpeditionOptions& options = {})
      : options_(options), coordinator_(options.coordination) {}

  /// Orders by name, for each robot whose pose is on the planner's map. `time_s`: of poses, never falling.
  std::map<std::string, ExplorationOrder> plan(Planner& planner,
                                               const std::map<std::string, ExpeditionMember>& team,
                                               double time_s);

  const ExpeditionCounts& counts() const { return counts_; }
  /// All that were there to share out when that was last done, as goals of cost 0.
  const std::vector<ExplorationGoal>& frontiers() const { return frontiers_; }

 private:
  struct State {
    std::optional<ExplorationGoal> goal;
    std::int64_t number = 0;  ///< of the goal
    std::vector<ManifoldPose> given_up;
    std::optional<ManifoldPose> just_visited;               ///< where it came to is no goal now
    std::vector<std::pair<double, ManifoldPose>> deferred;  ///< no goals until then
    std::optional<ManifoldPose> first;                      ///< where it was first
    int turns = 0;                                          ///< that it made there to look around
    bool turning = false;                                   ///< its goal is such a turn
    bool meeting = false;                                   ///< its goal is its place at a meeting
    double met_s = 0;                                       ///< when it was not there last
    Leave leave = Leave::go;
    std::optional<ManifoldPose> moved_from;
    double moved_s = 0;  ///< when it last got on, or need not
    double free_s = 0;   ///< when it last had not to wait for others
  };

  void look(const Planner& planner, const std::string& name, const ExpeditionMember& member, double time_s);
  void look_at_meeting(const Planner& planner, State& state, const ManifoldPose& pose, double time_s);
  void visit(const Planner& planner, State& state);
  void give_up(State& state);
  std::optional<ExplorationGoal> turn_to_look(const Planner& planner, State& state,
                                              const ManifoldPose& pose) const;
  void set_goal(const Planner& planner, State& state, const std::optional<ExplorationGoal>& goal,
                double time_s);
  bool can_meet(const Planner& planner, const std::map<std::string, ExpeditionMember>& team,
                const MeetingRecord& meeting) const;
  void look_after_meeting(const Planner& planner, const std::map<std::string, ExpeditionMember>& team);
  void arrange_meeting(Planner& planner, const std::map<std::string, ExpeditionMember>& team, double time_s);
  void send_to_meeting(const Planner& planner, const MeetingPlace& place, double time_s);
  void end_meeting();
  void share(Planner& planner, const std::map<std::string, ExpeditionMember>& team, double time_s);
  std::map<std::string, Traveller> travellers(Planner& planner,
                                              const std::map<std::string, ExpeditionMember>& team);
  ExplorationOrder order(const std::string& name, Clearance clearance, double time_s);

  ExpeditionOptions options_;
  Coordinator coordinator_;
  std::map<std::string, State> states_;
  std::optional<double> shared_s_;
  std::vector<ExplorationGoal> frontiers_;
  std::vector<ManifoldPose> visited_;     ///< goals that somebody came to
  std::vector<ManifoldPose> looked_at_;   ///< those of them that are no goals again, for anybody
  std::optional<MeetingRecord> meeting_;  ///< that two robots are on their way to
  std::set<ClosureId> missed_;            ///< hypotheses that a meeting did not settle
  ExpeditionCounts counts_;
};

}  // namespace isthmus
