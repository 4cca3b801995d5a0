// Localisation only: robots that come to a map which does not change.

#include <gtest/gtest.h>

#include <filesystem>

#include "tests/scenario/event_sequences.hpp"
#include "tests/support/recorded_data.hpp"
#include "tools/import/import.hpp"

namespace isthmus {
namespace {

/// Where robots were at their scans, in one plane.
using Truth = std::map<std::pair<std::string, std::int64_t>, Pose>;

Truth truth_of(const SimulatedRun& run) {
  Truth truth;
  for (const RobotTruth& robot : run.truth)
    for (const TruePose& pose : robot.poses) truth[{robot.robot, pose.utime}] = pose.world_from_robot;
  return truth;
}

/// Where a map of one island has its own scans.
Truth truth_of(const MapCopy& map) {
  Truth truth;
  for (const TrajectoryRow& row : map.trajectory->read(0, map.trajectory_rows))
    truth[{map.sessions.at(static_cast<std::size_t>(row.session)).robot, row.utime}] =
        map.poses.at(static_cast<std::size_t>(row.patch.value)) * row.patch_from_robot;
  return truth;
}

/// The scans of a run that one robot, under another name and at another time, repeats: its odometry begins at
/// zero.
struct Visit {
  std::string of;  ///< robot
  std::string as;
  std::int64_t from_utime = 0;
  std::int64_t to_utime = 0;
  std::int64_t later_us = 0;
};

Events events_of(const Visit& visit, const Events& events) {
  Events result;
  std::optional<Pose> zero_from_odom;
  for (Event event : events) {
    const bool here = event.receive_utime >= visit.from_utime && event.receive_utime < visit.to_utime;
    if (auto* robot = std::get_if<RobotEvent>(&event.body); robot && robot->robot == visit.of) {
      robot->robot = visit.as;
      robot->barcode = -1;
      event.receive_utime = visit.from_utime + visit.later_us;
    } else if (auto* odometry = std::get_if<OdometryEvent>(&event.body);
               odometry && odometry->robot == visit.of && here) {
      if (!zero_from_odom) zero_from_odom = inverse(odometry->odom_from_robot);
      odometry->robot = visit.as;
      odometry->utime += visit.later_us;
      odometry->odom_from_robot = *zero_from_odom * odometry->odom_from_robot;
      event.receive_utime += visit.later_us;
    } else if (auto* scan = std::get_if<ScanEvent>(&event.body); scan && scan->robot == visit.of && here) {
      scan->robot = visit.as;
      scan->scan.utime += visit.later_us;
      event.receive_utime += visit.later_us;
    } else {
      continue;
    }
    result.push_back(std::move(event));
  }
  return result;
}

/// How a robot fared.
struct Fared {
  int scans = 0;
  int scans_since = 0;  ///< the first pose, its own counted
  int poses = 0;
  int matched = 0;
  int wrong = 0;  ///< by more than a metre
  double found_s = std::numeric_limits<double>::infinity();
  double found_way_m = std::numeric_limits<double>::infinity();
  double mean_m = 0;
  double max_m = 0;

  bool found() const { return poses > 0; }
};

/// Sends the robot through the map. `truth` is of the map's scans and of the visit's, by the names and times
/// they had first.
Fared play(Engine& engine, const Visit& visit, const Events& events, const Truth& truth) {
  const MapCopy map = engine.copy();
  Fared fared;
  std::optional<Pose> odometry;
  double way_m = 0;
  std::int64_t begin = 0;
  for (const Event& event : events_of(visit, events)) {
    if (const auto* moved = std::get_if<OdometryEvent>(&event.body)) {
      const Pose step = odometry ? ominus(moved->odom_from_robot, *odometry) : Pose{};
      way_m += std::hypot(step.x, step.y);
      odometry = moved->odom_from_robot;
    }
    if (std::holds_alternative<ScanEvent>(event.body)) {
      if (fared.scans++ == 0) begin = event.receive_utime;
      if (fared.found()) ++fared.scans_since;
    }
    for (const RobotPose& pose : engine.handle(event).poses) {
      if (fared.poses++ == 0) {
        fared.found_s = 1e-6 * static_cast<double>(event.receive_utime - begin);
        fared.found_way_m = way_m;
        fared.scans_since = 1;
      }
      fared.matched += pose.matched ? 1 : 0;
      const Patch& patch = *map.patches.at(static_cast<std::size_t>(pose.pose.patch.value));
      const Pose world_from_robot = truth.at({visit.of, pose.utime - visit.later_us});
      const Pose off =
          ominus(pose.pose.patch_from_object, ominus(world_from_robot, truth.at({patch.robot, patch.utime})));
      const double off_m = std::hypot(off.x, off.y);
      fared.mean_m += off_m;
      fared.max_m = std::max(fared.max_m, off_m);
      if (off_m > 1) ++fared.wrong;
    }
  }
  if (fared.found()) fared.mean_m /= fared.poses;
  std::printf(
      "%s from %.0f s: %d scans, found after %.1f s, %.1f m; then %d of %d matched, error %.3f m, at "
      "most %.3f m, %d wrong\n",
      visit.of.c_str(), 1e-6 * static_cast<double>(visit.from_utime - events.front().receive_utime),
      fared.scans, fared.found_s, fared.found_way_m, fared.matched, fared.scans_since, fared.mean_m,
      fared.max_m, fared.wrong);
  return fared;
}

/// Visits of a robot, spread over its run, each much later than all before.
std::vector<Visit> visits_of(const std::string& robot, const Events& events, int count, double seconds,
                             int visits_before = 0) {
  const std::int64_t first = events.front().receive_utime;
  const std::int64_t length = events.back().receive_utime - first;
  std::vector<Visit> visits;
  for (int i = 0; i < count; ++i) {
    Visit visit{robot, "X" + std::to_string(visits_before + i), first + length * i / count, 0,
                (visits_before + i + 1) * 2 * length};
    visit.to_utime = visit.from_utime + static_cast<std::int64_t>(1e6 * seconds);
    visits.push_back(visit);
  }
  return visits;
}

/// A building's map, frozen, and another run through the building: the same tours, other noise. Its robots
/// are called otherwise.
struct Building {
  Engine engine;
  Events events;
  Truth truth;

  explicit Building(const std::string& scenario, const std::vector<std::string>& overrides = {}) {
    const SimulatedRun mapped = simulate(load_scenario(scenario, overrides), 1);
    for (const Event& event : mapped.events) engine.handle(event);
    engine.freeze();
    truth = truth_of(mapped);
    SimulatedRun other = simulate(load_scenario(scenario, overrides), 2);
    for (const auto& [key, pose] : truth_of(other)) truth[{"OTHER" + key.first, key.second}] = pose;
    events = std::move(other.events);
    for (Event& event : events) {
      const auto rename = [](auto& body) {
        if constexpr (requires { body.robot; }) body.robot = "OTHER" + body.robot;
      };
      std::visit(rename, event.body);
    }
  }
};

std::string sha256_of(const Engine& engine) { return map_sha256(engine.copy()); }

TEST(FrozenMap, StaysAsItIsWhileOthersDriveThroughIt) {
  Building office("office");
  const std::string before = sha256_of(office.engine);
  const std::int64_t later_us =
      2 * (office.events.back().receive_utime - office.events.front().receive_utime);
  for (Event event : office.events) {
    if (auto* robot = std::get_if<RobotEvent>(&event.body)) robot->barcode += 1000;
    if (auto* sighting = std::get_if<SightingEvent>(&event.body)) {
      sighting->barcode += 1000;
      sighting->utime += later_us;
    }
    if (auto* odometry = std::get_if<OdometryEvent>(&event.body)) odometry->utime += later_us;
    if (auto* scan = std::get_if<ScanEvent>(&event.body)) scan->scan.utime += later_us;
    event.receive_utime += later_us;
    office.engine.handle(event);
  }
  for (const Verb verb : {Verb::refine, Verb::withdraw, Verb::forbid, Verb::allow, Verb::drop}) {
    const Event order = command(office.events.back().receive_utime + later_us, verb, 0);
    EXPECT_EQ(office.engine.handle(order).drop_reason, DropReason::frozen) << word(verb);
  }
  office.engine.finish();
  EXPECT_EQ(sha256_of(office.engine), before);
  const MapCopy map = office.engine.copy();
  EXPECT_GT(map.counters.dropped.at(DropReason::frozen), 100);
  for (const char* robot : {"OTHERR1", "OTHERR2", "OTHERR3", "OTHERR4"})
    EXPECT_EQ(sessions_of(map, robot).size(), 1U) << robot;
}

TEST(FrozenMap, FindsNewRobotsWhereverTheyBegin) {
  Building office("office");
  int visits = 0;
  for (const char* robot : {"OTHERR1", "OTHERR2", "OTHERR3", "OTHERR4"}) {
    for (const Visit& visit : visits_of(robot, office.events, 2, 90, visits)) {
      ++visits;
      const Fared fared = play(office.engine, visit, office.events, office.truth);
      EXPECT_LT(fared.found_way_m, 20);
      EXPECT_GE(fared.matched, 0.99 * fared.scans_since);
      EXPECT_LT(fared.mean_m, 0.03);
      EXPECT_EQ(fared.wrong, 0);
    }
  }
}

TEST(FrozenMap, LosesARobotThatIsCarriedAwayAndFindsItAgain) {
  Building office("office");
  for (Visit visit : visits_of("OTHERR1", office.events, 3, 60)) {
    visit.as = "X";
    const Fared fared = play(office.engine, visit, office.events, office.truth);
    EXPECT_TRUE(fared.found());
    EXPECT_EQ(fared.wrong, 0);
  }
  EXPECT_EQ(sessions_of(office.engine.copy(), "X").size(), 3U);
}

// Twelve rooms that look alike: better no place than a wrong one, however long the robot drives among them.
TEST(FrozenMap, PlacesNobodyInRoomsThatLookAlike) {
  Building rooms("repeated_rooms");
  for (const Visit& visit : visits_of("OTHERR1", rooms.events, 2, 60)) {
    const Fared fared = play(rooms.engine, visit, rooms.events, rooms.truth);
    EXPECT_GT(fared.scans, 250);
    EXPECT_FALSE(fared.found());
  }
}

// Two wings of one plan: a robot that drives from one to the other passes what is there only once.
TEST(FrozenMap, PlacesARobotInTheRightOneOfTwoWingsOnceItHasSeenWhatTellsThemApart) {
  Building wings("two_wings");
  int found = 0;
  for (const Visit& visit : visits_of("OTHERR1", wings.events, 4, 150)) {
    const Fared fared = play(wings.engine, visit, wings.events, wings.truth);
    EXPECT_EQ(fared.wrong, 0);
    found += fared.found() ? 1 : 0;
  }
  EXPECT_GE(found, 2);
}

/// A robot that comes back over known ground while the server is stopped and started again.
struct Return {
  Events before;
  Events after;

  Return() {
    const Events events = simulate(load_scenario("repeated_rooms"), 1).events;
    const std::int64_t stop = events.back().receive_utime - 40'000'000;
    for (const Event& event : events) (event.receive_utime < stop ? before : after).push_back(event);
  }

  Engine frozen() const {
    Engine engine;
    for (const Event& event : before) engine.handle(event);
    engine.freeze();
    return engine;
  }
};

/// Whether each scan was matched, in order.
std::vector<bool> matches(Engine& engine, const Events& events) {
  std::vector<bool> matched;
  for (const Event& event : events)
    for (const RobotPose& pose : engine.handle(event).poses) matched.push_back(pose.matched);
  return matched;
}

std::int64_t scans_in(const Events& events) {
  return std::ranges::count_if(
      events, [](const Event& event) { return std::holds_alternative<ScanEvent>(event.body); });
}

TEST(FrozenMap, MatchesARobotThatGoesOnFromItsFirstScanOn) {
  const Return back;
  Engine engine = back.frozen();
  const std::vector<bool> matched = matches(engine, back.after);
  EXPECT_GE(std::ssize(matched), scans_in(back.after));
  EXPECT_EQ(std::ranges::count(matched, false), 0);
}

TEST(FrozenMap, MatchesARobotThatRestartedWhereItWas) {
  const Return back;
  for (const bool announced : {false, true}) {
    Engine engine = back.frozen();
    Events after = back.after;
    std::optional<Pose> zero_from_odom;
    for (Event& event : after) {
      auto* odometry = std::get_if<OdometryEvent>(&event.body);
      if (!odometry) continue;
      if (!zero_from_odom) zero_from_odom = inverse(odometry->odom_from_robot);
      odometry->odom_from_robot = *zero_from_odom * odometry->odom_from_robot;
    }
    if (announced) {
      auto robot = std::get<RobotEvent>(std::ranges::find_if(back.before, [](const Event& e) {
                                          return std::holds_alternative<RobotEvent>(e.body);
                                        })->body);
      robot.restarted = true;
      after.insert(after.begin(), {after.front().receive_utime, robot});
    }
    const std::vector<bool> matched = matches(engine, after);
    EXPECT_GE(std::ssize(matched), scans_in(after) - 3) << announced;
    EXPECT_EQ(std::ranges::count(matched, false), 0) << announced;
  }
}

Events recorded_intel() {
  const std::string file = data_directory() + "/bench/intel.clf.gz";
  Events events;
  if (!std::filesystem::exists(file)) return events;
  CarmenImport what;
  what.logs = {{"R1", file}};
  import_carmen(what, [&](const Event& event) { events.push_back(event); });
  return events;
}

Engine map_until(const Events& events, std::int64_t utime) {
  Engine engine;
  for (const Event& event : events)
    if (event.receive_utime < utime) engine.handle(event);
  engine.freeze();
  return engine;
}

// A recorded building: robots begin anywhere in its second half, in the map of the whole and of the first
// half, which has the places but not the scans. The map of the whole serves as truth.
TEST(FrozenMap, FindsRobotsInARecordedBuilding) {
  const Events events = recorded_intel();
  if (events.empty()) GTEST_SKIP() << "no recorded data (ISTHMUS_DATA)";
  const std::int64_t end = events.back().receive_utime;
  const std::int64_t middle = events.front().receive_utime + (end - events.front().receive_utime) / 2;
  Engine whole = map_until(events, end + 1);
  Engine half = map_until(events, middle);
  const Truth truth = truth_of(whole.copy());
  int found = 0;
  for (const Visit& visit : visits_of("R1", events, 16, 120)) {
    if (visit.from_utime < middle) continue;
    const Fared in_whole = play(whole, visit, events, truth);
    EXPECT_TRUE(in_whole.found());
    EXPECT_EQ(in_whole.wrong, 0);
    const Fared in_half = play(half, visit, events, truth);
    EXPECT_EQ(in_half.wrong, 0);
    found += in_half.found() ? 1 : 0;
  }
  EXPECT_GE(found, 5);
}

}  // namespace
}  // namespace isthmus
