// The two ways to handle what comes, by the engine that has the one, and then the other.

#include "server/engine/handling.hpp"

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "server/engine/engine.hpp"
#include "server/engine/localising.hpp"
#include "server/engine/mapping.hpp"
#include "server/engine/outcome.hpp"
#include "server/engine/record/trajectory_store.hpp"
#include "tests/support/walls.hpp"

namespace isthmus {
namespace {

using namespace isthmus::testing;

// R1, with a laser and barcode 1, has driven 2 m through a room; R2 has barcode 2 and R3 has no laser.
class AMappedRoom {
 public:
  AMappedRoom() {
    introduce("R1", 1, laser_of());
    introduce("R2", 2, laser_of());
    Laser none = laser_of();
    none.range_min_m = none.range_max_m = 0;
    introduce("R3", 3, none);
    for (int i = 0; i <= 20; ++i) drive_to({-2 + 0.1 * i, -1, 0});
  }

  Outcome drive_to(const Pose& pose) {
    utime_ += 200'000;
    engine.handle({utime_, OdometryEvent{"R1", utime_, pose}});
    return engine.handle({utime_, ScanEvent{"R1", scan_from(furnished_room(), pose, utime_)}});
  }
  DropReason blind_odometry() {
    return engine.handle({utime_, OdometryEvent{"R3", utime_, Pose{}}}).drop_reason;
  }
  DropReason see(int barcode) {
    return engine.handle({utime_, SightingEvent{"R1", utime_, barcode, 2, 0.1, 0.5, 0.02}}).drop_reason;
  }
  DropReason draw(AnnotationKind kind, const std::string& name) {
    AnnotationEvent event;
    event.kind = kind;
    event.name = name;
    event.island = IslandId{0};
    if (kind == AnnotationKind::place) event.points = {{PatchId{}, {1, 0}}};
    if (is_zone(kind)) event.points = {{PatchId{}, {0, 0}}, {PatchId{}, {1, 0}}, {PatchId{}, {0, 1}}};
    return engine.handle({utime_, event}).drop_reason;
  }
  DropReason say_where(const std::string& robot, const Pose& pose) {
    InitialPoseEvent event;
    event.robot = robot;
    event.island = IslandId{0};
    event.pose = pose;
    event.sigma_m = event.sigma_rad = 0.3;
    return engine.handle({utime_, event}).drop_reason;
  }
  DropReason order(Verb verb) {
    return engine.handle({utime_, CommandEvent{utime_, verb, 7, "R1"}}).drop_reason;
  }

  Engine engine;

 private:
  void introduce(const std::string& name, int barcode, const Laser& laser) {
    RobotEvent event;
    event.robot = name;
    event.utime = utime_;
    event.barcode = barcode;
    event.laser = laser;
    engine.handle({utime_, event});
  }

  std::int64_t utime_ = 1'000'000'000;
};

TEST(Mapping, TakesWhatChangesTheMap) {
  AMappedRoom room;
  const std::size_t patches = room.engine.copy().patches.size();
  EXPECT_EQ(room.blind_odometry(), DropReason::none);
  EXPECT_EQ(room.see(2), DropReason::none);
  EXPECT_EQ(room.order(Verb::refine), DropReason::none);
  EXPECT_EQ(room.order(Verb::allow), DropReason::not_dropped);
  for (int i = 1; i <= 15; ++i) room.drive_to({0.1 * i, -1, 0});
  EXPECT_GT(room.engine.copy().patches.size(), patches);
  EXPECT_EQ(room.engine.copy().sightings.size(), 1U);
}

std::shared_ptr<TrajectoryStore> rows_of(const Engine& engine) {
  const MapCopy map = engine.copy();
  auto rows = std::make_shared<TrajectoryStore>();
  for (const TrajectoryRow& row : map.trajectory->read(0, map.trajectory_rows)) rows->append(row);
  return rows;
}

// They are of the map, and of a snapshot of it; one without any is saved as it was before there were such.
TEST(Mapping, KeepsWhatOperatorsDraw) {
  AMappedRoom room;
  const std::string plain = map_sha256(room.engine.copy());
  const std::vector<std::uint8_t> saved_plain = room.engine.save();
  EXPECT_EQ(room.draw(AnnotationKind::keep_out, "stairs"), DropReason::none);
  EXPECT_EQ(room.draw(AnnotationKind::place, "stairs"), DropReason::name_taken);
  EXPECT_EQ(room.engine.copy().counters.dropped.at(DropReason::name_taken), 1);
  const std::string drawn = map_sha256(room.engine.copy());
  EXPECT_NE(drawn, plain);
  const std::vector<std::uint8_t> saved = room.engine.save();
  const Engine again = Engine::restore(saved, rows_of(room.engine));
  EXPECT_EQ(map_sha256(again.copy()), drawn);
  EXPECT_EQ(again.save(), saved);
  EXPECT_EQ(room.draw(AnnotationKind::erase, "Stairs"), DropReason::none);
  EXPECT_EQ(map_sha256(room.engine.copy()), plain);
  EXPECT_TRUE(Engine::restore(saved_plain, rows_of(room.engine)).copy().annotations.empty());
}

// R1's patches are all there are: a zone goes with its data, and comes back with it.
TEST(Mapping, SaysThatAZoneIsLostWithTheDataOfItsRobot) {
  AMappedRoom room;
  room.draw(AnnotationKind::keep_out, "stairs");
  EXPECT_EQ(room.order(Verb::drop), DropReason::none);
  ASSERT_EQ(room.engine.copy().annotations.size(), 1U);
  EXPECT_TRUE(room.engine.copy().annotations.front().lost);
  EXPECT_EQ(room.order(Verb::allow), DropReason::none);
  EXPECT_FALSE(room.engine.copy().annotations.front().lost);
}

TEST(Mapping, PlacesNoRobotBecauseSomebodySaysSo) {
  AMappedRoom room;
  EXPECT_EQ(room.say_where("R1", {}), DropReason::not_finished);
  EXPECT_EQ(room.say_where("R9", {}), DropReason::unknown_robot);
}

TEST(Localising, PlacesARobotWhereItIsSaidToBe) {
  AMappedRoom room;
  room.engine.freeze();
  EXPECT_EQ(room.draw(AnnotationKind::place, "Dock"), DropReason::frozen)
      << "it would be gone with the server: the journal is only read";
  EXPECT_EQ(room.say_where("R1", {100, 0, 0}), DropReason::off_the_map);
  EXPECT_EQ(room.say_where("R1", {1, 0, 0}), DropReason::none);
}

TEST(Localising, RefusesAsFrozenWhatWouldChangeTheMap) {
  AMappedRoom room;
  room.engine.freeze();
  EXPECT_TRUE(room.engine.is_frozen());
  EXPECT_EQ(room.blind_odometry(), DropReason::frozen) << "its way would have to become a map";
  EXPECT_EQ(room.see(2), DropReason::none) << "it says where the other is, who is not found";
  EXPECT_EQ(room.see(2), DropReason::frozen) << "that it has said";
  EXPECT_EQ(room.see(77), DropReason::unknown_barcode) << "why it is of no use in any map comes first";
  for (const Verb verb : {Verb::withdraw, Verb::forbid, Verb::allow, Verb::drop, Verb::refine})
    EXPECT_EQ(room.order(verb), DropReason::frozen) << word(verb);
  EXPECT_EQ(room.order(Verb::send_map), DropReason::none);
  EXPECT_TRUE(room.engine.copy().sightings.empty()) << "the log of sightings is the map's";
}

TEST(Localising, TellsWhereTheRobotIsAndLeavesTheMap) {
  AMappedRoom room;
  room.engine.freeze();
  const std::string before = map_sha256(room.engine.copy());
  Outcome outcome;
  for (int i = 1; i <= 15; ++i) outcome = room.drive_to({0.1 * i, -1, 0});
  ASSERT_EQ(outcome.poses.size(), 1U);
  EXPECT_TRUE(outcome.poses[0].matched);
  EXPECT_NEAR(outcome.poses[0].map_from_robot.x, 3.5, 0.05) << "from where it began";
  EXPECT_EQ(map_sha256(room.engine.copy()), before);
  EXPECT_FALSE(room.engine.has_queued_work());
}

// All of finishing is answering what waits.
TEST(Localising, FinishesInOneStep) {
  AMappedRoom room;
  room.engine.freeze();
  Outcome outcome;
  EXPECT_EQ(room.engine.finishing(), "waiting scans");
  EXPECT_FALSE(room.engine.finish_step(outcome));
}

TEST(Mapping, FinishesInSteps) {
  AMappedRoom room;
  Outcome outcome;
  EXPECT_EQ(room.engine.finishing(), "waiting scans");
  EXPECT_TRUE(room.engine.finish_step(outcome));
  EXPECT_EQ(room.engine.finishing(), "the running trial");
  std::vector<std::string> stages;
  while (room.engine.finish_step(outcome))
    if (stages.empty() || stages.back() != room.engine.finishing())
      stages.emplace_back(room.engine.finishing());
  EXPECT_EQ(stages,
            (std::vector<std::string>{"trials of waiting sightings", "searches", "trials of finds",
                                      "trials of sightings", "matches of nearby patches", "the last fit"}))
      << "what waits merges islands before places are searched for on them";
  EXPECT_EQ(room.engine.finishing(), "waiting scans") << "whoever goes on may finish again";
}

}  // namespace
}  // namespace isthmus
