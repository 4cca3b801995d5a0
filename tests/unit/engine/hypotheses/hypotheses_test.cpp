// Hypotheses from the events on: what is asked, found and proposed by scans alone.

#include "server/engine/hypotheses/hypotheses.hpp"

#include <gtest/gtest.h>

#include <utility>

#include "server/engine/engine.hpp"
#include "server/engine/hypotheses/find_record.hpp"
#include "tests/support/walls.hpp"
#include "tests/support/ways.hpp"

namespace isthmus {
namespace {

using namespace isthmus::testing;

// Robots that drive along a hall, 1 m/s, and see nobody; if not told otherwise no two views of it are alike.
class InAHall {
 public:
  explicit InAHall(const EngineOptions& options = {}, Walls walls = niched_hall(), double range_m = 20)
      : walls_(std::move(walls)), range_m_(range_m) {
    Configuration configuration;
    configuration.engine = options;
    engine = Engine(configuration);
  }
  // Returns the map after so many metres.
  MapCopy drive(const std::string& name, double way_m) {
    RobotEvent robot;
    robot.robot = name;
    robot.utime = utime_;
    robot.laser = laser_of(range_m_);
    engine.handle({utime_, robot});
    for (double x = 0; x <= way_m; x += 0.2) {
      utime_ += 200'000;
      const Pose world_from_robot{x, 0.1, 0};
      engine.handle({utime_, OdometryEvent{name, utime_, world_from_robot}});
      engine.handle({utime_, ScanEvent{name, scan_from(walls_, world_from_robot, utime_, range_m_)}});
    }
    return engine.copy();
  }

  Engine engine;

 private:
  Walls walls_;
  double range_m_;
  std::int64_t utime_ = 1'000'000'000;
};

// A hall of 14 m of which no two views are alike, and 36 m more that look alike every 6 m.
Walls hall_that_goes_on_alike() {
  Walls walls;
  add_box(walls, -3, -2, 60, 2);
  double x = -2;
  double side = 1;
  for (const double width : {0.4, 1.1, 0.6, 0.9, 0.3, 0.7}) {
    add_box(walls, x, side * 2 - 0.5, x + width, side * 2 + 0.5);
    x += 1.8 + width;
    side = -side;
  }
  for (x = 14; x < 60; x += 6) {
    add_box(walls, x, 1.5, x + 0.8, 2.5);
    add_box(walls, x + 2.5, -2.5, x + 2.9, -1.5);
  }
  return walls;
}

// Every two metres, once five metres of way say enough to be looked for.
TEST(Hypotheses, AskEveryTwoMetresOfARobotsWay) {
  EXPECT_EQ(InAHall().drive("R1", 4).hypotheses.queries, 0);
  EXPECT_EQ(InAHall().drive("R1", 6.5).hypotheses.queries, 1);
  const std::int64_t asked = InAHall().drive("R1", 16).hypotheses.queries;
  EXPECT_GE(asked, 4);
  EXPECT_LE(asked, 6);
}

// A loop may be driven shut less than two metres before the end.
TEST(Hypotheses, AskAtTheEndOfWhatWasDrivenSinceTheyLastAsked) {
  InAHall hall;
  const std::int64_t asked = hall.drive("R1", 9.5).hypotheses.queries;
  hall.engine.finish();
  EXPECT_EQ(hall.engine.copy().hypotheses.queries, asked + 1);
  hall.engine.finish();
  EXPECT_EQ(hall.engine.copy().hypotheses.queries, asked + 1) << "once";
  InAHall short_of_a_piece;
  short_of_a_piece.drive("R1", 4);
  short_of_a_piece.engine.finish();
  EXPECT_EQ(short_of_a_piece.engine.copy().hypotheses.queries, 0);
}

TEST(Hypotheses, SearchNothingWhereThereIsNoOtherPlace) {
  InAHall hall;
  hall.drive("R1", 16);
  hall.engine.finish();
  EXPECT_EQ(hall.engine.copy().hypotheses.places_searched, 0) << "what lies behind is known for sure";
}

// The second robot's way is found on the first's island, again and again; but one hall proves nothing: what
// they share is one corridor, and neither goes on beyond it.
TEST(Hypotheses, OfTwoMapsThatShareOneHallWait) {
  InAHall hall;
  hall.drive("R1", 16);
  hall.drive("R2", 16);
  hall.engine.finish();
  const MapCopy map = hall.engine.copy();
  EXPECT_GE(map.hypotheses.places_searched, 3);
  EXPECT_GE(map.hypotheses.finds, 3);
  EXPECT_EQ(map.graph.islands().size(), 2U);
  ASSERT_EQ(map.finds.size(), static_cast<std::size_t>(map.hypotheses.finds));
  for (const FindRecord& find : map.finds) {
    EXPECT_NE(map.patches[static_cast<std::size_t>(find.query.value)]->robot,
              map.patches[static_cast<std::size_t>(find.anchor.value)]->robot);
    EXPECT_EQ(find.way_m, 0) << "they are on two islands";
    EXPECT_TRUE(find.waits);
  }
}

TEST(Hypotheses, TellOfFindsThatAreTooUnsureToWaitToo) {
  EngineOptions options;
  options.hypotheses.min_find_probability = 1;
  InAHall hall(options);
  hall.drive("R1", 16);
  hall.drive("R2", 16);
  hall.engine.finish();
  const MapCopy map = hall.engine.copy();
  EXPECT_EQ(map.hypotheses.finds, 0);
  ASSERT_FALSE(map.finds.empty());
  EXPECT_FALSE(map.finds.front().waits);

  options.hypotheses.max_recorded_finds = 1;
  InAHall forgetful(options);
  forgetful.drive("R1", 16);
  forgetful.drive("R2", 16);
  forgetful.engine.finish();
  ASSERT_EQ(forgetful.engine.copy().finds.size(), 1U);
  EXPECT_EQ(forgetful.engine.copy().finds[0].query, map.finds.back().query) << "the newest";
}

// Nothing is searched before the end, and only one query waits for its turn.
TEST(Hypotheses, WhoseTurnNewerOnesTakeAreSearchedForOnOtherIslandsToo) {
  const auto after_the_end = [](std::size_t max_queries) {
    EngineOptions options;
    options.hypotheses.work_share = 0;
    options.hypotheses.max_queries = max_queries;
    InAHall hall(options);
    hall.drive("R1", 16);
    hall.drive("R2", 16);
    hall.engine.finish();
    return hall.engine.copy().hypotheses;
  };
  const HypothesisCounts in_turn = after_the_end(100);
  const HypothesisCounts late = after_the_end(1);
  EXPECT_GE(late.queries_put_off, 6);
  EXPECT_GE(late.finds, 3);
  EXPECT_EQ(late.finds, in_turn.finds);
}

TEST(Hypotheses, ThatFitAnotherIslandSeveralTimesAreToldApartByTheWayThere) {
  InAHall hall({}, hall_that_goes_on_alike(), 6);
  hall.drive("R1", 46);
  hall.drive("R2", 46);
  hall.engine.finish();
  const MapCopy map = hall.engine.copy();
  const auto at = [&](PatchId id) { return map.poses[static_cast<std::size_t>(id.value)]; };
  EXPECT_GE(map.hypotheses.ambiguous, 3);
  int among_look_alikes = 0;
  for (const FindRecord& find : map.finds) {
    ASSERT_NE(map.patches[static_cast<std::size_t>(find.query.value)]->robot,
              map.patches[static_cast<std::size_t>(find.anchor.value)]->robot);
    EXPECT_NEAR((at(find.anchor) * find.anchor_from_query).x, at(find.query).x, 0.5) << "not 6 m off";
    among_look_alikes += find.look_alikes > 1 ? 1 : 0;
  }
  EXPECT_GE(among_look_alikes, 2);
}

/// Two robots that drove along the hall, R2 half a metre beside R1, and whose maps have become one where they
/// began: how they lie to one another is known to a metre or so, and all of R2's is off by that.
struct JoinedAtOneEnd {
  JoinedAtOneEnd() {
    std::vector<Pose> ways[2];
    for (int i = 0; i <= 16; ++i)
      for (const int robot : {0, 1}) ways[robot].push_back({1.0 * i, robot == 0 ? 0.1 : 0.6, 0});
    first = add_way(map, niched_hall(), ways[0]);
    second = add_way(map, niched_hall(), ways[1], {0.4, 0.3, 0}, "R2");
    map.relate(odometry_relation(first.front(), second.front(),
                                 map.relative_pose(first.front(), second.front()), {1, 1, 100}));
  }
  void ask_again(const std::vector<std::vector<PatchId>>& sides) {
    hypotheses.ask_again(map, sides, options.hypotheses);
    finish();
  }
  /// Another patch so many metres along the second way.
  PatchId patch(const std::string& robot, int x) {
    return add_way(map, niched_hall(), {{1.0 * x, 0.6, 0}}, {0.4, 0.3, 0}, robot).front();
  }
  void match(PatchId a, PatchId b) {
    Relation matched = odometry_relation(a, b, map.relative_pose(a, b));
    matched.kind = RelationKind::point_to_line;
    map.relate(matched);
  }
  /// As if R2's patches came now; no time is left for searches.
  void drive_second() {
    options.hypotheses.work_share = 0;
    Closures closures;
    for (const PatchId id : second) {
      robots["R2"].place.emplace();
      robots["R2"].place->last_patch = id;
      hypotheses.advance({map, robots, options}, closures);
    }
  }
  void finish() {
    Closures closures;
    const World world{map, robots, options};
    hypotheses.begin_finish(world, closures);
    while (hypotheses.finish_search(world)) {
    }
  }

  Map map;
  std::map<std::string, Robot> robots;
  EngineOptions options;
  std::vector<PatchId> first;
  std::vector<PatchId> second;
  Hypotheses hypotheses;
};

TEST(Hypotheses, WhoseTurnNewerOnesTakeAreSearchedWhenNoneWaits) {
  JoinedAtOneEnd in_turn;
  in_turn.drive_second();
  in_turn.finish();
  EXPECT_EQ(in_turn.hypotheses.counts().queries_put_off, 0);
  JoinedAtOneEnd late;
  late.options.hypotheses.max_queries = 1;
  late.drive_second();
  EXPECT_GE(late.hypotheses.counts().queries_put_off, 3);
  late.finish();
  EXPECT_EQ(late.hypotheses.counts().queries, in_turn.hypotheses.counts().queries);
  EXPECT_EQ(late.hypotheses.counts().places_searched, in_turn.hypotheses.counts().places_searched);
  EXPECT_GE(late.hypotheses.counts().finds, 2);
  EXPECT_EQ(late.hypotheses.counts().finds, in_turn.hypotheses.counts().finds);
}

// Nobody drives there any more, and both had been there before the two were on one map.
TEST(Hypotheses, AfterAMergeFindTheWaysOfOneSideOnTheOther) {
  JoinedAtOneEnd joined;
  joined.ask_again({joined.second});
  EXPECT_EQ(joined.hypotheses.counts().queries, 6);
  ASSERT_GE(joined.hypotheses.found().size(), 2U);
  for (const FindRecord& find : joined.hypotheses.found()) {
    ASSERT_GE(find.query, joined.second.front());
    ASSERT_LT(find.anchor, joined.second.front()) << "its own ground was searched when it was new";
    const int query = find.query.value - joined.second.front().value, anchor = find.anchor.value;
    EXPECT_NEAR(find.anchor_from_query.x, query - anchor, 0.1);
    EXPECT_NEAR(find.anchor_from_query.y, 0.5, 0.1) << "as it was, not as the map has it";
  }
}

TEST(Hypotheses, AfterAMergeSearchNoneOfARobotsOwnSide) {
  JoinedAtOneEnd joined;
  std::vector<PatchId> both = joined.first;
  both.insert(both.end(), joined.second.begin(), joined.second.end());
  joined.ask_again({both});
  EXPECT_EQ(joined.hypotheses.counts().queries, 12);
  EXPECT_EQ(joined.hypotheses.counts().places_searched, 0);
}

// R3's patches lie on those of R2: where R2's way is among others' is known, though R1's are far by the way.
TEST(Hypotheses, AfterAMergeSearchForNoWayThatIsMatchedWithAnother) {
  JoinedAtOneEnd joined;
  for (int i = 0; i <= 16; i += 2)
    joined.match(joined.second[static_cast<std::size_t>(i)], joined.patch("R3", i));
  joined.ask_again({joined.second});
  EXPECT_EQ(joined.hypotheses.counts().queries, 6);
  EXPECT_EQ(joined.hypotheses.counts().places_searched, 0);

  JoinedAtOneEnd with_its_own;
  for (int i = 0; i <= 16; i += 2)
    with_its_own.match(with_its_own.second[static_cast<std::size_t>(i)], with_its_own.patch("R2", i));
  with_its_own.ask_again({with_its_own.second});
  EXPECT_GE(with_its_own.hypotheses.found().size(), 2U);
}

// Its islands merged one after the other: what was on the smaller side both times is asked of once, of all
// that was new to it the first time.
TEST(Hypotheses, AfterSeveralMergesAskOncePerPieceOfWay) {
  JoinedAtOneEnd joined;
  std::vector<PatchId> both = joined.first;
  both.insert(both.end(), joined.second.begin(), joined.second.end());
  joined.ask_again({joined.second, both});
  EXPECT_EQ(joined.hypotheses.counts().queries, 6 + 6);
  ASSERT_GE(joined.hypotheses.found().size(), 2U);
  for (const FindRecord& find : joined.hypotheses.found())
    EXPECT_GE(find.query, joined.second.front()) << "of R1's nothing is new";
}

TEST(Hypotheses, OfBeforeAMergeAreNotAskedAgainForARobotWhoseDataIsDropped) {
  JoinedAtOneEnd joined;
  joined.hypotheses.ask_again(joined.map, std::vector<std::vector<PatchId>>{joined.second},
                              joined.options.hypotheses);
  EXPECT_TRUE(joined.hypotheses.has_work());
  joined.hypotheses.forget_robot(joined.map, "R2");
  EXPECT_FALSE(joined.hypotheses.has_work());
}

}  // namespace
}  // namespace isthmus
