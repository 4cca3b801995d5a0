// Operators draw on the map while it is made, merged and parted, sensibly and not: the map is as without, a
// replay and a restored snapshot have the same places and zones, and paths can be planned.

#include "server/engine/annotations/annotations.hpp"

#include <gtest/gtest.h>

#include <random>

#include "server/output/tables/annotation_table.hpp"
#include "server/paths/questions/planner.hpp"
#include "server/wire/message/message.hpp"
#include "tests/scenario/event_sequences.hpp"

namespace isthmus {
namespace {

/// Annotations of any kind, shape, frame and name, and orders that part and join islands.
class AnyOperator {
 public:
  explicit AnyOperator(unsigned seed) : random_(seed) {}

  Event next(std::int64_t utime) {
    const int kind = below(12);
    if (kind == 0)
      return {utime, CommandEvent{utime, below(2) == 0 ? Verb::withdraw : Verb::allow, below(3), ""}};
    if (kind == 1) return {utime, CommandEvent{utime, below(3) == 0 ? Verb::drop : Verb::allow, -1, "R2"}};
    return {utime, annotation(utime)};
  }

 private:
  AnnotationEvent annotation(std::int64_t utime) {
    AnnotationEvent event;
    event.utime = utime;
    event.kind = std::array{AnnotationKind::place, AnnotationKind::keep_out, AnnotationKind::speed,
                            AnnotationKind::erase}[static_cast<std::size_t>(below(4))];
    event.name = std::string(1, static_cast<char>('a' + below(12)));
    event.replace = below(2) == 0;
    event.max_speed_m_s = event.kind == AnnotationKind::speed ? 0.5 : 0;
    event.yaw_rad = event.kind == AnnotationKind::place ? uniform(-3, 3) : 0;
    const bool in_plane = below(2) == 0;
    if (in_plane) event.island = IslandId{below(3) == 0 ? below(60) : 0};
    const double size_m = below(8) == 0 ? 1e6 : 4;
    const PatchId patch{below(40) - 1};
    int points = is_zone(event.kind) ? 3 + below(6) : 0;
    if (event.kind == AnnotationKind::place) points = 1;
    for (int i = 0; i < points; ++i) {
      const double angle = below(5) == 0 ? uniform(0, 7) : 6.283 * i / points;
      event.points.push_back({in_plane || below(9) == 0 ? PatchId{below(60) - 1} : patch,
                              size_m * uniform(0.3, 1) * Eigen::Vector2d(std::cos(angle), std::sin(angle))});
    }
    return event;
  }

  int below(int end) { return std::uniform_int_distribution<int>(0, end - 1)(random_); }
  double uniform(double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(random_);
  }

  std::mt19937 random_;
};

bool is_annotation(const Event& event) { return std::holds_alternative<AnnotationEvent>(event.body); }

Events drawn_on(unsigned seed) {
  Events events = simulate(load_scenario("meeting"), 1).events;
  AnyOperator operators(seed);
  const std::int64_t end = events.back().receive_utime;
  for (std::int64_t utime = after_s(events, 1); utime < end; utime += 100'000)
    insert(events, operators.next(utime));
  return events;
}

std::string geojson_of(const MapCopy& map) { return annotations_geojson(map, rank_islands(map)); }

MapCopy finished(Engine engine) {
  engine.finish();
  return engine.copy();
}

class DrawnOn : public testing::TestWithParam<unsigned> {};

// But that time passes when somebody draws: what the engine works on meanwhile has its turns.
TEST_P(DrawnOn, TheMapIsAsWithout) {
  const Events events = drawn_on(GetParam());
  Events without = events;
  for (Event& event : without)
    if (is_annotation(event)) event.body = TickEvent{};
  MapCopy map = map_events(events);
  EXPECT_FALSE(map.annotations.empty());
  map.annotations.clear();
  EXPECT_EQ(map_sha256(map), map_sha256(map_events(without)));
}

TEST_P(DrawnOn, ARestoredEngineHasTheSamePlacesAndZones) {
  const Events events = drawn_on(GetParam());
  Engine uninterrupted, interrupted;
  for (std::size_t i = 0; i < events.size(); ++i) {
    uninterrupted.handle(events[i]);
    interrupted.handle(events[i]);
    if (i % 500 != 499) continue;
    const std::vector<std::uint8_t> saved = interrupted.save();
    ASSERT_EQ(saved, uninterrupted.save()) << "at event " << i;
    interrupted = Engine::restore(saved, rows_of(interrupted));
  }
  const MapCopy map = finished(std::move(uninterrupted)), again = finished(std::move(interrupted));
  EXPECT_EQ(map_sha256(again), map_sha256(map));
  EXPECT_EQ(geojson_of(again), geojson_of(map));
}

TEST_P(DrawnOn, AReplayOfTheMessagesHasTheSamePlacesAndZones) {
  const Events events = drawn_on(GetParam());
  Engine first, second;
  std::map<DropReason, int> refused;
  for (const Event& event : events) {
    const Message message = encode(event);
    const Decoded decoded = decode({}, message.channel, message.bytes, message.utime);
    if (!decoded.event) {
      ASSERT_TRUE(is_annotation(event)) << word(decoded.reason);
      refused[decoded.reason] += 1;
      continue;
    }
    const DropReason reason = first.handle(*decoded.event).drop_reason;
    if (is_annotation(event)) refused[reason] += 1;
    EXPECT_EQ(second.handle(*decode({}, message.channel, message.bytes, message.utime).event).drop_reason,
              reason);
  }
  for (const DropReason reason :
       {DropReason::none, DropReason::name_taken, DropReason::no_such_name, DropReason::unknown_patch,
        DropReason::bad_polygon, DropReason::off_the_map})
    EXPECT_GT(refused[reason], 0) << "the operator is not unruly enough: " << word(reason);
  const MapCopy map = finished(std::move(first)), again = finished(std::move(second));
  EXPECT_EQ(map_sha256(again), map_sha256(map));
  EXPECT_EQ(geojson_of(again), geojson_of(map));
}

TEST_P(DrawnOn, WhatIsNotLostLiesOnOneIslandAndPathsCanBePlanned) {
  const auto map = std::make_shared<const MapCopy>(map_events(drawn_on(GetParam())));
  for (const AnnotationRecord& record : map->annotations) {
    ASSERT_EQ(record.points.empty(), false) << record.name;
    for (const ManifoldPose& point : record.points) {
      if (record.lost) continue;
      EXPECT_EQ(map->graph.island(point.patch), record.island) << record.name;
      EXPECT_FALSE(is_left_out(*map, point.patch)) << record.name;
    }
  }
  Planner planner;
  planner.update(map);
  const PatchId last{static_cast<std::int32_t>(map->patches.size()) - 1};
  const Path path = planner.path({{PatchId{0}, {}}, {last, {}}, {0.2, 0.05}});
  EXPECT_EQ(path.max_speeds_m_s.size(), path.poses.size()) << word(path.refusal);
}

INSTANTIATE_TEST_SUITE_P(Seeds, DrawnOn, testing::Range(1U, 5U));

}  // namespace
}  // namespace isthmus
