#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "server/engine/engine.hpp"
#include "server/exploration/expedition.hpp"
#include "tools/simulate/live/live_team.hpp"

namespace isthmus {

/// Robots in a closed loop with the engine and the planner, in one process and in the time of the run: what
/// they send is what the map is made of, and what they drive is in its frame.
class ServedTeam {
 public:
  ServedTeam(const Scenario& scenario, std::uint64_t seed, const std::vector<Pose>& starts,
             double clearance_m)
      : team_(scenario, seed, starts), answers_(team_.size()), clearance_m_(clearance_m) {}

  /// Robots sense, and the engine takes it. `LiveTeam::move` ends the tick.
  void sense();
  /// The planner's map is the engine's from now on.
  void update_map();
  /// A robot drives along a path on the planner's map, and at its end turns to a heading, if one is given. An
  /// empty path: it stands. A robot that is backing off by itself goes on with that.
  void follow(std::size_t i, const std::vector<ManifoldPose>& path, std::optional<double> map_heading_rad);

  void obey(std::size_t i, const ExplorationOrder& order);

  LiveTeam& robots() { return team_; }
  const LiveTeam& robots() const { return team_; }
  Planner& planner() { return planner_; }
  const Planner& planner() const { return planner_; }
  /// Those that are on the planner's map, by name.
  std::map<std::string, ExpeditionMember> members() const;
  Footprint footprint(std::size_t i) const { return {team_[i].robot.plan().radius_m, clearance_m_}; }
  /// The newest.
  const std::optional<RobotPose>& answer(std::size_t i) const { return answers_[i]; }
  /// That robots are on.
  std::size_t islands() const;

 private:
  void handle(decltype(Event::body) body);
  void localise(std::size_t i);

  Engine engine_;
  Planner planner_;
  LiveTeam team_;
  std::vector<std::optional<RobotPose>> answers_;  // by robot
  double clearance_m_;
};

}  // namespace isthmus
