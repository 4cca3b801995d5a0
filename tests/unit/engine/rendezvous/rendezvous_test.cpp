#include "server/engine/rendezvous/rendezvous.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <numbers>
#include <optional>
#include <string>
#include <vector>

#include "server/engine/rendezvous/meeting_record.hpp"
#include "tests/support/relations.hpp"
#include "tests/support/start_utime.hpp"
#include "tests/support/walls.hpp"

namespace isthmus {
namespace {

using namespace isthmus::testing;

using std::numbers::pi;
constexpr ClosureId guess{7};

// Two robots have each mapped a part of the furnished room; where the parts lie to one another is a
// guess, and a right one.
//
//      +-----------+
//      |  []    #  |     R1's patches 0, 1: at (-2, 0) and (-1, 0), looking along x
//      | 0>1>  <2  |     R2's patches 2, 3: at (1.5, 0) and (1, -1), looking against x
//      |      <3   |
//      +-----------+
class RendezvousTest : public ::testing::Test {
 protected:
  RendezvousTest() {
    add("R1", {-2, 0, 0});
    add("R1", {-1, 0, 0});
    add("R2", {1.5, 0, pi});
    add("R2", {1, -1, pi});
    relate(0, 1);
    relate(2, 3);
    robots_["R1"].declaration = {"R1", 0, 101, laser_of(), 0.25, false};
    robots_["R2"].declaration = {"R2", 0, 102, laser_of(), 0.25, false};
    for (auto& [name, robot] : robots_) robot.declared = true;
    stand("R1", 0, Pose{});
    stand("R2", 2, Pose{});
    guess_ = {guess, PatchId{0}, PatchId{2}, ominus(world_[2], world_[0]), 10};
  }

  void add(const std::string& robot, const Pose& world_from_patch) {
    const PatchId id = map_.manifold().next_id();
    const bool of_first = robot == "R1";
    world_.push_back(world_from_patch);
    // Each island has a plane of its own: the world's, and one shifted and turned.
    map_.add(make_patch(id, robot, scan_from(furnished_room(), world_from_patch), laser_of(), {}),
             of_first ? world_from_patch : Pose{50, 20, 1} * world_from_patch);
  }

  void relate(int a, int b) { map_.relate(odometry_between(a, b)); }

  void stand(const std::string& robot, int patch, const Pose& patch_from_robot) {
    robots_[robot].place = Localisation{};
    robots_[robot].place->pose = {PatchId{patch}, patch_from_robot};
  }

  void stand_at(const MeetingPlace& place, const Pose& meeting_from_robot = {}) {
    stand(place.robot, place.pose.patch.value, place.pose.patch_from_object * meeting_from_robot);
  }

  Pose world_of(const ManifoldPose& pose) const {
    return world_[static_cast<std::size_t>(pose.patch.value)] * pose.patch_from_object;
  }

  Pose world_of_robot(const std::string& robot) const { return world_of(robots_.at(robot).place->pose); }

  // What a robot sees where it stands.
  Scan scan_of(const std::string& robot, const Walls& walls = furnished_room()) const {
    return scan_from(walls, world_of_robot(robot));
  }

  // Both robots look for so long; returns the hypothesis that they refute.
  std::optional<ClosureId> watch(Rendezvous& rendezvous, double from_s, double to_s,
                                 const Walls& walls = furnished_room()) {
    for (double time_s = from_s; time_s < to_s; time_s += 0.2) {
      for (const char* robot : {"R1", "R2"}) {
        const auto refuted =
            rendezvous.take_scan(map_, robots_, robot, scan_of(robot, walls), utime(time_s), {});
        if (refuted) return refuted;
      }
    }
    return std::nullopt;
  }

  Rendezvous chosen() {
    Rendezvous rendezvous;
    rendezvous.choose(map_, robots_, std::vector{guess_}, utime(0), {});
    return rendezvous;
  }

  static std::int64_t utime(double time_s) {
    return start_utime + static_cast<std::int64_t>(std::llround(time_s * 1e6));
  }

  Map map_;
  std::vector<Pose> world_;
  std::map<std::string, Robot> robots_;
  UndecidedHypothesis guess_;
};

TEST_F(RendezvousTest, PlacesAreNearFaceOneAnotherAndAreFree) {
  const auto plan = plan_meeting(map_, robots_, guess_, {});
  ASSERT_TRUE(plan);
  EXPECT_EQ(plan->a.robot, "R1");
  EXPECT_EQ(plan->b.robot, "R2");
  EXPECT_LT(plan->a.pose.patch.value, 2);
  EXPECT_GE(plan->b.pose.patch.value, 2);
  const Pose a = world_of(plan->a.pose), b = world_of(plan->b.pose);
  const Pose b_seen = ominus(b, a), a_seen = ominus(a, b);
  EXPECT_GE(std::hypot(b_seen.x, b_seen.y), 1.49);
  EXPECT_LE(std::hypot(b_seen.x, b_seen.y), 2.01);
  EXPECT_NEAR(std::atan2(b_seen.y, b_seen.x), 0, 1e-9);
  EXPECT_NEAR(std::atan2(a_seen.y, a_seen.x), 0, 1e-9);
  for (const Pose& pose : {a, b}) {
    EXPECT_LT(std::abs(pose.x), 4 - 0.25);
    EXPECT_LT(std::abs(pose.y), 3 - 0.25);
    const bool in_cupboard = pose.x > 2.25 && pose.y > 1.55;
    EXPECT_FALSE(in_cupboard);
  }
}

TEST_F(RendezvousTest, NoMeetingOfRobotsThatCannotSeeOneAnotherOrAreElsewhere) {
  auto blind = robots_;
  blind["R2"].declaration.barcode = -1;
  EXPECT_FALSE(plan_meeting(map_, blind, guess_, {}));
  auto gone = robots_;
  gone["R2"].place.reset();
  EXPECT_FALSE(plan_meeting(map_, gone, guess_, {}));
  relate(1, 2);  // the islands have become one
  EXPECT_FALSE(plan_meeting(map_, robots_, guess_, {}));
}

// Were the guess true, nothing that the one knows for free would be near what the other knows.
TEST_F(RendezvousTest, NoMeetingOfIslandsThatWouldNotTouch) {
  UndecidedHypothesis behind = guess_;
  behind.first_from_second = Pose{14, 0, 0};
  EXPECT_FALSE(plan_meeting(map_, robots_, behind, {}));
}

TEST_F(RendezvousTest, TheMostValuableHypothesisIsChosenAndKept) {
  UndecidedHypothesis other = guess_;
  other.id = ClosureId{8};
  other.value = 15;
  Rendezvous rendezvous;
  rendezvous.choose(map_, robots_, std::vector{guess_, other}, utime(0), {});
  ASSERT_TRUE(rendezvous.meeting());
  EXPECT_EQ(rendezvous.meeting()->hypothesis.id, other.id);
  EXPECT_FALSE(rendezvous.is_due(utime(0.5)));
  EXPECT_TRUE(rendezvous.is_due(utime(1)));
  UndecidedHypothesis risen = guess_;
  risen.value = 20;  // not worth turning for
  rendezvous.choose(map_, robots_, std::vector{risen, other}, utime(1), {});
  EXPECT_EQ(rendezvous.meeting()->hypothesis.id, other.id);
  risen.value = 40;
  rendezvous.choose(map_, robots_, std::vector{risen, other}, utime(2), {});
  EXPECT_EQ(rendezvous.meeting()->hypothesis.id, guess);
  rendezvous.choose(map_, robots_, std::vector<UndecidedHypothesis>{}, utime(3), {});
  EXPECT_FALSE(rendezvous.record());
}

TEST_F(RendezvousTest, TwoThatStandFaceToFaceForFiveSecondsAndSeeNobodyRefuteIt) {
  Rendezvous rendezvous = chosen();
  ASSERT_TRUE(rendezvous.record());
  EXPECT_FALSE(watch(rendezvous, 0, 10)) << "they are not there yet";
  stand_at(rendezvous.meeting()->a);
  stand_at(rendezvous.meeting()->b);
  EXPECT_FALSE(watch(rendezvous, 20, 24.9));
  EXPECT_EQ(watch(rendezvous, 25, 25.5), guess);
  EXPECT_FALSE(rendezvous.meeting());
}

TEST_F(RendezvousTest, ASightingBeginsTheWatchAnew) {
  Rendezvous rendezvous = chosen();
  stand_at(rendezvous.meeting()->a);
  stand_at(rendezvous.meeting()->b);
  EXPECT_FALSE(watch(rendezvous, 0, 4.5));
  rendezvous.take_sighting("R2", "R1");
  EXPECT_FALSE(watch(rendezvous, 4.6, 9.4));
  rendezvous.take_sighting("R3", "R1");  // another robot saw one of them
  EXPECT_TRUE(watch(rendezvous, 9.6, 10.4));
}

TEST_F(RendezvousTest, OneAloneProvesNothingNorDoesAPause) {
  Rendezvous rendezvous = chosen();
  stand_at(rendezvous.meeting()->a);
  EXPECT_FALSE(watch(rendezvous, 0, 8));
  stand_at(rendezvous.meeting()->b);
  EXPECT_FALSE(watch(rendezvous, 8, 12));
  EXPECT_FALSE(watch(rendezvous, 14, 18.8)) << "nobody knows what was between";
  EXPECT_TRUE(watch(rendezvous, 18.8, 19.6));
}

TEST_F(RendezvousTest, TooFarOrTurnedAwayProvesNothing) {
  Rendezvous rendezvous = chosen();
  const MeetingPlace a = rendezvous.meeting()->a, b = rendezvous.meeting()->b;
  stand_at(b);
  stand_at(a, {0, 0, 25 * pi / 180});
  EXPECT_FALSE(watch(rendezvous, 0, 8));
  stand_at(a, {-1.1, 0, 0});
  EXPECT_FALSE(watch(rendezvous, 10, 18));
  stand_at(a, {-0.3, 0, 15 * pi / 180});
  EXPECT_TRUE(watch(rendezvous, 20, 28));
}

// A box stands between the two that the islands do not know: they could not have seen one another.
TEST_F(RendezvousTest, WhereSomethingIsInTheWayNothingIsProved) {
  Rendezvous rendezvous = chosen();
  stand_at(rendezvous.meeting()->a);
  stand_at(rendezvous.meeting()->b);
  const Pose a = world_of_robot("R1"), b = world_of_robot("R2");
  const double x = 0.5 * (a.x + b.x), y = 0.5 * (a.y + b.y);
  Walls walls = furnished_room();
  add_box(walls, x - 0.2, y - 0.2, x + 0.2, y + 0.2);
  EXPECT_FALSE(watch(rendezvous, 0, 8, walls));
  EXPECT_TRUE(watch(rendezvous, 10, 16));
}

// Something of a robot's size stands where the other would be: it may be the other, its barcode unread.
TEST_F(RendezvousTest, WhereSomebodyStandsNothingIsProved) {
  Rendezvous rendezvous = chosen();
  stand_at(rendezvous.meeting()->a);
  stand_at(rendezvous.meeting()->b);
  const Pose b = world_of_robot("R2");
  Walls walls = furnished_room();
  add_box(walls, b.x - 0.2, b.y - 0.2, b.x + 0.2, b.y + 0.2);
  for (double time_s = 0; time_s < 8; time_s += 0.2) {
    const Scan seen = scan_of("R1", walls), clear = scan_of("R2");
    EXPECT_FALSE(rendezvous.take_scan(map_, robots_, "R1", seen, utime(time_s), {}));
    EXPECT_FALSE(rendezvous.take_scan(map_, robots_, "R2", clear, utime(time_s), {}));
  }
}

}  // namespace
}  // namespace isthmus
