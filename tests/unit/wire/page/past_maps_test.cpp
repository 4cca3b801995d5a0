#include "server/wire/page/past_maps.hpp"

#include <gtest/gtest.h>

#include <filesystem>
#include <nlohmann/json.hpp>
#include <thread>

#include "server/wire/journal/journal_files.hpp"
#include "server/wire/journal/recovery/snapshots.hpp"
#include "tests/support/team_journal.hpp"
#include "tests/unit/wire/page/page_maps.hpp"

namespace isthmus {
namespace {

using Json = nlohmann::json;
namespace fs = std::filesystem;
using testing::shown_of;

constexpr std::int64_t first_version = 5000;
class PastMapsOfAJournal : public ::testing::Test {
 protected:
  PastMapsOfAJournal() { update_snapshots(journal_); }

  int newest() { return list_journal(journal_).snapshots.rbegin()->first; }
  MapCopy newest_map() { return read_snapshot(snapshot_path(journal_, newest())).map.engine.copy(); }
  Json list() { return Json::parse(past_.list(shown_of(newest_map()))); }

  const TemporaryDirectory directory_;
  const std::string journal_ = write_team_journal(directory_);
  PastMaps past_{journal_, first_version};
};

TEST_F(PastMapsOfAJournal, AreListedWithTheirTimes) {
  const Json listed = list();
  ASSERT_EQ(listed.size(), list_journal(journal_).snapshots.size());
  int before = -1;
  for (const Json& one : listed) {
    const Snapshot snapshot = read_snapshot(snapshot_path(journal_, one.at("snapshot")));
    EXPECT_EQ(one.at("events"), snapshot.map.events);
    EXPECT_NEAR(one.at("time"), 1e-6 * static_cast<double>(snapshot.map.last_utime), 1e-6);
    // Rounds are a tenth of a second apart, of four messages each.
    EXPECT_NEAR(one.at("end").get<double>(), static_cast<double>(snapshot.map.events) / 4, 3);
    EXPECT_GT(one.at("end"), before);
    before = one.at("end");
  }
}

TEST_F(PastMapsOfAJournal, AreMarkedByTheServersClockAsPatchesAre) {
  const Json listed = list();
  MapCopy map = newest_map();
  for (HealthRecord& record : map.health) *record.figures.clock_ahead_s += 1000;
  const Json again = Json::parse(past_.list(shown_of(map)));
  for (std::size_t i = 0; i < listed.size(); ++i) EXPECT_EQ(again[i].at("end"), listed[i].at("end"));
}

TEST_F(PastMapsOfAJournal, AreTheMapAsItWasWithRobotsWhereTheyWere) {
  const auto first = past_.find(1).map;
  const auto last = past_.find(newest()).map;
  ASSERT_TRUE(first && last);
  EXPECT_LT(first->shown.map().patches.size(), last->shown.map().patches.size());
  const Json text = Json::parse(*last->text);
  EXPECT_EQ(text.at("snapshot"), newest());
  ASSERT_EQ(text.at("islands").size(), 2U);
  EXPECT_GT(text.at("islands")[0].at("patches"), 0);
  ASSERT_EQ(text.at("robots").size(), 2U);
  for (const char* key : {"trails", "tags", "annotations", "closures"})
    EXPECT_TRUE(text.contains(key)) << key;
  const MapCopy map = read_snapshot(snapshot_path(journal_, newest())).map.engine.copy();
  const TrajectoryRow row = map.trajectory->read(map.trajectory_rows - 1, 1).front();
  const Pose at = last->shown.project({row.patch, row.patch_from_robot});
  const std::string robot = map.sessions[static_cast<std::size_t>(row.session)].robot;
  for (const Json& one : text.at("robots")) {
    if (one.at("name") != robot) continue;
    EXPECT_NEAR(one.at("at")[1], at.x, 1e-3);
    EXPECT_NEAR(one.at("at")[2], at.y, 1e-3);
  }
  EXPECT_GT(text.at("trails").at("R1").size(), 3U);
}

TEST_F(PastMapsOfAJournal, HaveTilesAndPatchesOfTheirOwn) {
  const auto map = past_.find(newest()).map;
  ASSERT_TRUE(map);
  const auto tiles = map->tiles.changed_since(PatchId{0}, 0);
  ASSERT_FALSE(tiles.empty());
  EXPECT_GT(tiles.front().version, first_version) << "no earlier run has come to it";
  ASSERT_TRUE(map->tiles.image(PatchId{0}, tiles.front().key));
  EXPECT_FALSE(patch_arrays(map->shown, PatchId{0}).empty());
}

TEST_F(PastMapsOfAJournal, AreReadOnceAndTwoAreKept) {
  const auto first = past_.find(1).map;
  EXPECT_EQ(past_.find(1).map, first);
  past_.find(2);
  EXPECT_EQ(past_.find(1).map, first) << "used last";
  past_.find(3);
  EXPECT_EQ(past_.find(1).map, first);
  const std::weak_ptr<PastMap> second = past_.find(2).map;
  past_.find(1);
  past_.find(3);
  EXPECT_TRUE(second.expired()) << "memory is bounded";
}

TEST_F(PastMapsOfAJournal, OneThatIsGoneOrNeverWasIsNotFound) {
  fs::remove(snapshot_path(journal_, 2));
  for (const int snapshot : {2, 99, 0, -1}) {
    const PastMaps::Found found = past_.find(snapshot);
    EXPECT_FALSE(found.map);
    EXPECT_EQ(found.status, 404);
    EXPECT_EQ(found.why, "there is no snapshot " + std::to_string(snapshot) + ", or no longer");
  }
}

TEST_F(PastMapsOfAJournal, OneThatIsDamagedSaysSoAndIsListedSo) {
  flip_a_bit(snapshot_path(journal_, 2));
  const PastMaps::Found found = past_.find(2);
  EXPECT_FALSE(found.map);
  EXPECT_EQ(found.status, 500);
  EXPECT_EQ(found.why, "snapshot-000002.isthmus: is damaged: its checksum is another");
  EXPECT_EQ(list()[1].at("error"), found.why);
  EXPECT_TRUE(past_.find(1).map);
}

TEST_F(PastMapsOfAJournal, OneWhoseRowsAreDamagedSaysSo) {
  flip_a_bit(trajectory_path(journal_, 1));
  const PastMaps::Found found = past_.find(newest());
  EXPECT_EQ(found.status, 500);
  EXPECT_EQ(found.why, "trajectory-000001.isthmus: is damaged: its checksum is another");
}

TEST_F(PastMapsOfAJournal, OneThatIsReplacedIsLookedAtAgain) {
  flip_a_bit(snapshot_path(journal_, 2));
  EXPECT_TRUE(list()[1].contains("error"));
  flip_a_bit(snapshot_path(journal_, 2));
  fs::last_write_time(snapshot_path(journal_, 2), fs::file_time_type::clock::now() + std::chrono::hours(1));
  EXPECT_FALSE(list()[1].contains("error"));
}

TEST_F(PastMapsOfAJournal, OneOfAnotherJournalIsNotShown) {
  const TemporaryDirectory elsewhere;
  const std::string other = write_team_journal(elsewhere);
  update_snapshots(other);
  fs::copy_file(snapshot_path(other, 2), snapshot_path(journal_, 2), fs::copy_options::overwrite_existing);
  const PastMaps::Found found = past_.find(2);
  EXPECT_EQ(found.status, 500);
  EXPECT_EQ(found.why, "snapshot-000002.isthmus: is of another journal");
}

TEST_F(PastMapsOfAJournal, ManyAskersGetOneOrAreToldToComeAgain) {
  std::atomic<int> shown = 0;
  const ShownMap now = shown_of(newest_map());
  std::vector<std::jthread> askers;
  for (int i = 0; i < 4; ++i) {
    askers.emplace_back([&, i] {
      for (int round = 0; round < 6; ++round) {
        const PastMaps::Found found = past_.find(1 + (i + round) % 3);
        EXPECT_TRUE(found.map ? found.status == 200 : found.status == 503) << found.status;
        if (found.map) shown += 1;
        past_.list(now);
      }
    });
  }
  askers.clear();
  EXPECT_GT(shown, 0);
}

TEST(PastMaps, AreNoneWithoutAJournalOrOfOneThatIsGone) {
  for (const char* directory : {"", "/nowhere/at/all"}) {
    PastMaps past(directory, first_version);
    EXPECT_TRUE(past.snapshots().empty());
    EXPECT_EQ(past.list(shown_of({})), "[]");
    EXPECT_EQ(past.find(1).status, 404);
  }
}

}  // namespace
}  // namespace isthmus
