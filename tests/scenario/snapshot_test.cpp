// An engine that was saved and restored goes on as the one it was taken of, whatever it was about to do.

#include <gtest/gtest.h>

#include <algorithm>
#include <iterator>
#include <random>

#include "server/engine/annotations/annotations.hpp"
#include "server/engine/snapshot/snapshot_values.hpp"
#include "tests/scenario/event_sequences.hpp"

namespace isthmus {
namespace {

struct Case {
  std::string scenario;
  std::vector<std::string> overrides;
  std::size_t events_between;  ///< two snapshots, at most
};

void PrintTo(const Case& tried, std::ostream* out) { *out << tried.scenario; }

class EngineSnapshot : public testing::TestWithParam<Case> {};

TEST_P(EngineSnapshot, GoesOnAsTheEngineThatItWasTakenOf) {
  const Case& tried = GetParam();
  const Events events = simulate(load_scenario(tried.scenario, tried.overrides), 1).events;
  std::mt19937 random(1);
  std::uniform_int_distribution<std::size_t> gap(1, tried.events_between);
  Engine uninterrupted;
  Engine interrupted;
  std::size_t next = gap(random);
  for (std::size_t i = 0; i < events.size(); ++i) {
    uninterrupted.handle(events[i]);
    interrupted.handle(events[i]);
    if (i < next) continue;
    next += gap(random);
    const std::vector<std::uint8_t> saved = interrupted.save();
    ASSERT_EQ(saved, uninterrupted.save()) << "at event " << i;
    interrupted = Engine::restore(saved, rows_of(interrupted));
  }
  uninterrupted.finish();
  interrupted.finish();
  const MapCopy map = uninterrupted.copy();
  EXPECT_EQ(map_sha256(interrupted.copy()), map_sha256(map));
  EXPECT_EQ(interrupted.save(), uninterrupted.save());
  EXPECT_GT(map.patches.size(), 10U);
}

INSTANTIATE_TEST_SUITE_P(Scenarios, EngineSnapshot,
                         testing::Values(Case{"meeting", {}, 150}, Case{"tags", {}, 700},
                                         Case{"blind", {}, 700}, Case{"kidnap", {}, 1500},
                                         Case{"two_wings_apart", {}, 700}),
                         [](const auto& tried) { return tried.param.scenario; });

std::string why_refused(std::span<const std::uint8_t> saved, std::shared_ptr<TrajectoryStore> rows) {
  try {
    Engine::restore(saved, std::move(rows));
  } catch (const std::exception& error) {
    return error.what();
  }
  return "";
}

TEST(EngineSnapshot, IsRefusedWhereItIsNotWhole) {
  const Events events = simulate(load_scenario("meeting", {}), 1).events;
  Engine engine;
  for (std::size_t i = 0; i < events.size() / 2; ++i) engine.handle(events[i]);
  std::vector<std::uint8_t> saved = engine.save();
  EXPECT_EQ(why_refused(saved, rows_of(engine)), "");
  EXPECT_NE(why_refused(saved, std::make_shared<TrajectoryStore>()), "");
  for (std::size_t size = 0; size < saved.size(); size += 1 + saved.size() / 300)
    EXPECT_NE(why_refused(std::span(saved).first(size), rows_of(engine)), "") << size;
  saved.push_back(0);
  EXPECT_EQ(why_refused(saved, rows_of(engine)), "it ends too early") << "behind the map are annotations";
  AnnotationEvent place;
  place.name = "Dock";
  place.island = IslandId{0};
  place.points = {{PatchId{}, {0, 0}}};
  ASSERT_EQ(engine.handle({events[events.size() / 2].receive_utime, place}).drop_reason, DropReason::none);
  saved = engine.save();
  EXPECT_EQ(why_refused(saved, rows_of(engine)), "");
  saved.push_back(0);
  EXPECT_EQ(why_refused(saved, rows_of(engine)), "it ends too early") << "behind them are corrected rows";
}

TEST(EngineSnapshot, OfARowCorrectedThatIsNotThereIsRefused) {
  Engine engine;
  std::vector<std::uint8_t> saved = engine.save();
  SnapshotWriter behind;
  behind(Annotations{}, std::vector<RowCorrection>{{0, PatchId{0}, {}}});
  std::ranges::copy(behind.take(), std::back_inserter(saved));
  EXPECT_EQ(why_refused(saved, rows_of(engine)), "it corrects a row that it lacks");
  saved.push_back(0);
  EXPECT_EQ(why_refused(saved, rows_of(engine)), "it does not end where it should");
}

}  // namespace
}  // namespace isthmus
