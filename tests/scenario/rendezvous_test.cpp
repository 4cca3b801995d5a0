#include "server/engine/rendezvous/rendezvous.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "server/engine/engine.hpp"
#include "tests/scenario/event_sequences.hpp"
#include "tools/simulate/truth/true_patches.hpp"

// Two wings of one plan, one turned by half a circle against the other, and two robots that have mapped. A
// hypothesis says how their islands lie to one another; the engine is asked where a meeting would settle it,
// the robots drive there and wait.

namespace isthmus {
namespace {

constexpr ClosureId guess{3};
constexpr double corridor_y_m = 6;
const Pose east_from_west{50, 12, std::numbers::pi};  // half a circle about the lobby's middle, (25, 6)

// A robot's patch, whatever its id in another run.
struct PatchKey {
  std::string robot;
  std::int64_t utime = 0;
};

PatchId find(const MapCopy& map, const PatchKey& key) {
  const auto found = std::ranges::find_if(map.patches, [&](const PatchPtr& patch) {
    return patch->robot == key.robot && patch->utime == key.utime;
  });
  return found == map.patches.end() ? PatchId{} : (*found)->id;
}

// Two patches and what is said of them.
struct Guess {
  PatchKey first;
  PatchKey second;
  Pose first_from_second;

  UndecidedHypothesis hypothesis(const MapCopy& map) const {
    return {guess, find(map, first), find(map, second), first_from_second, 10};
  }
};

// What the engine of a run knows, where Rendezvous can see it.
class Watched {
 public:
  Outcome handle(const Event& event) {
    if (const auto* robot = std::get_if<RobotEvent>(&event.body)) {
      robots_[robot->robot].declaration = *robot;
      robots_[robot->robot].declared = true;
    }
    Outcome outcome = engine_.handle(event);
    for (const RobotPose& pose : outcome.poses) {
      robots_[pose.robot].place = Localisation{};
      robots_[pose.robot].place->pose = pose.pose;
      robots_[pose.robot].place->utime = pose.utime;
    }
    return outcome;
  }

  // The map as it is now; made anew only where patches were added or islands merged.
  const Map& map() {
    const MapCopy copy = engine_.copy();
    if (copy.patches.size() == map_.manifold().size() && copy.graph.islands().size() == islands_) return map_;
    map_ = Map{};
    islands_ = copy.graph.islands().size();
    for (std::size_t i = 0; i < copy.patches.size(); ++i) map_.add(copy.patches[i], copy.poses[i]);
    for (const auto& [id, relation] : copy.graph.relations()) map_.relate(relation);
    return map_;
  }

  void finish() { engine_.finish(); }
  MapCopy copy() const { return engine_.copy(); }
  const std::map<std::string, Robot>& robots() const { return robots_; }

 private:
  Engine engine_;
  std::map<std::string, Robot> robots_;
  Map map_;
  std::size_t islands_ = 0;
};

// The patch of a robot in the corridor nearest to a place of the world.
std::size_t corridor_patch(const MapCopy& map, const std::vector<std::optional<TruePatch>>& truth,
                           const std::string& robot, double x_m) {
  std::size_t best = 0;
  double nearest_m = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < map.patches.size(); ++i) {
    if (map.patches[i]->robot != robot || !truth[i]) continue;
    const Pose& pose = truth[i]->world_from_patch;
    const double off_m = std::hypot(pose.x - x_m, pose.y - corridor_y_m);
    if (off_m >= nearest_m) continue;
    nearest_m = off_m;
    best = i;
  }
  return best;
}

// To a place of the world, on through it a little so that the robot faces where it should, and wait.
void drive_to(RobotPlan& robot, const Pose& world_from_meeting) {
  const Eigen::Vector2d place(world_from_meeting.x, world_from_meeting.y);
  robot.tour.push_back(Waypoint{{place.x(), corridor_y_m}});
  robot.tour.push_back(Waypoint{place});
  robot.tour.push_back(Waypoint{place + rotate(world_from_meeting.yaw, {0.2, 0})});
  robot.tour.push_back(Wait{12});
}

// Robots go exactly where they are sent.
Scenario two_wings() { return load_scenario("two_wings_apart", {"drive.waypoint_jitter_m=0"}); }

struct Met {
  bool planned = false;
  std::optional<ClosureId> refuted;
  std::size_t islands = 0;
};

// Maps a scenario, plans a meeting at its end, and runs it again with the robots going there.
Met meet(const Scenario& scenario, const std::function<Pose(const Pose&, const Pose&)>& said) {
  const SimulatedRun run = simulate(scenario, 1);
  Watched mapped;
  for (const Event& event : run.events) mapped.handle(event);
  const MapCopy copy = mapped.copy();
  const auto truth = true_patches(copy, run.truth);
  const std::size_t first = corridor_patch(copy, truth, "R1", 10);
  const Pose& world_of_second = run.truth[1].poses.back().world_from_robot;
  const bool is_east = world_of_second.x > 25;
  const std::size_t second = corridor_patch(copy, truth, "R2", is_east ? 39 : 11);
  const Guess guessed{{"R1", copy.patches[first]->utime},
                      {"R2", copy.patches[second]->utime},
                      said(truth[first]->world_from_patch, truth[second]->world_from_patch)};
  const auto plan = plan_meeting(mapped.map(), mapped.robots(), guessed.hypothesis(copy), {});
  Met met;
  if (!plan) return met;
  met.planned = true;
  const auto world_of = [&](const MeetingPlace& place) {
    return truth[static_cast<std::size_t>(place.pose.patch.value)]->world_from_patch *
           place.pose.patch_from_object;
  };

  Scenario with_meeting = scenario;
  drive_to(with_meeting.robots[0], world_of(plan->a));
  drive_to(with_meeting.robots[1], world_of(plan->b));
  const SimulatedRun meeting = simulate(with_meeting, 1);
  const std::int64_t from_utime = run.events.back().receive_utime;
  Watched driven;
  Rendezvous rendezvous;
  for (const Event& event : meeting.events) {
    driven.handle(event);
    if (event.receive_utime < from_utime || met.refuted) continue;
    if (rendezvous.is_due(event.receive_utime)) {
      const MapCopy now = driven.copy();
      rendezvous.choose(driven.map(), driven.robots(), std::vector{guessed.hypothesis(now)},
                        event.receive_utime, {});
    }
    if (const auto* scan = std::get_if<ScanEvent>(&event.body)) {
      met.refuted = rendezvous.take_scan(driven.map(), driven.robots(), scan->robot, scan->scan,
                                         event.receive_utime, {});
    }
    if (const auto* sighting = std::get_if<SightingEvent>(&event.body))
      rendezvous.take_sighting(sighting->robot, sighting->barcode == 101 ? "R1" : "R2");
  }
  driven.finish();
  met.islands = driven.copy().graph.islands().size();
  return met;
}

// The islands look as if the robots were in one wing: they go where they would meet, and meet nobody.
TEST(RendezvousScenario, AWrongGuessIsRefutedByMeetingNobody) {
  const Met met = meet(two_wings(), [](const Pose& first, const Pose& second) {
    return ominus(inverse(east_from_west) * second, first);
  });
  ASSERT_TRUE(met.planned);
  EXPECT_EQ(met.refuted, guess);
  EXPECT_EQ(met.islands, 2U);
}

// The same, all of it the engine's own: the search of scans makes the hypothesis, which stays undecided as
// neither map goes on beyond what they seem to share; the meeting it asks for is driven to; nobody is there.
TEST(RendezvousScenario, TheEnginesOwnHypothesisIsRefutedWhereItAskedToMeet) {
  const Scenario scenario = two_wings();
  const SimulatedRun run = simulate(scenario, 1);
  Engine engine;
  for (const Event& event : run.events) engine.handle(event);
  const MapCopy copy = engine.copy();
  ASSERT_TRUE(copy.meeting);
  EXPECT_EQ(copy.graph.islands().size(), 2U);
  const auto of_meeting = [&](const MapCopy& map) {
    return *std::ranges::find(map.closures, copy.meeting->closure, &ClosureRecord::id);
  };
  EXPECT_EQ(of_meeting(copy).state, ClosureState::waiting);
  const auto truth = true_patches(copy, run.truth);
  Scenario with_meeting = scenario;
  for (const MeetingPlace& place : {copy.meeting->a, copy.meeting->b}) {
    const auto robot = std::ranges::find(with_meeting.robots, place.robot, &RobotPlan::name);
    drive_to(*robot, truth[static_cast<std::size_t>(place.pose.patch.value)]->world_from_patch *
                         place.pose.patch_from_object);
  }
  Engine driven;
  for (const Event& event : simulate(with_meeting, 1).events) driven.handle(event);
  driven.finish();
  const MapCopy after = driven.copy();
  EXPECT_EQ(of_meeting(after).state, ClosureState::refused);
  EXPECT_EQ(of_meeting(after).reason, Reason::met_nobody);
  EXPECT_EQ(after.graph.islands().size(), 2U);
}

// Both are in the west wing, and read barcodes only when they go to meet: they see one another, and the
// sightings merge their islands.
TEST(RendezvousScenario, ARightGuessIsConfirmedBySightings) {
  Scenario scenario = two_wings();
  RobotPlan& second = scenario.robots[1];
  second.start = scenario.robots[0].start;
  second.tour = scenario.robots[0].tour;
  second.tour.pop_back();
  second.start_s = 40;
  const std::int64_t end_utime = simulate(scenario, 1).events.back().receive_utime;
  for (RobotPlan& robot : scenario.robots)
    robot.camera.from_s = 1e-6 * static_cast<double>(end_utime - scenario.start_utime);
  const Met met =
      meet(scenario, [](const Pose& first, const Pose& second_pose) { return ominus(second_pose, first); });
  ASSERT_TRUE(met.planned);
  EXPECT_FALSE(met.refuted);
  EXPECT_EQ(met.islands, 1U);
}

}  // namespace
}  // namespace isthmus
