#include "server/engine/record/trajectory_store.hpp"

#include <gtest/gtest.h>

#include <atomic>
#include <cstdlib>
#include <filesystem>
#include <thread>

#include "tests/unit/output/room.hpp"

namespace isthmus {
namespace {

TrajectoryRow row(std::int64_t i) {
  const auto number = static_cast<std::int32_t>(i);
  return {1'000 * i, number % 7, PatchId{number / 3}, {0.5 * number, -1.0 * number, 0.001 * number}};
}

void expect_row(const TrajectoryRow& found, std::int64_t i) {
  const TrajectoryRow wanted = row(i);
  EXPECT_EQ(found.utime, wanted.utime);
  EXPECT_EQ(found.session, wanted.session);
  EXPECT_EQ(found.patch, wanted.patch);
  EXPECT_EQ(found.patch_from_robot, wanted.patch_from_robot);
}

/// Sets $TMPDIR while it lives.
class TmpdirIs {
 public:
  explicit TmpdirIs(const std::string& directory) {
    if (const char* old = std::getenv("TMPDIR")) old_ = old;
    ::setenv("TMPDIR", directory.c_str(), 1);
  }
  ~TmpdirIs() {
    if (old_.empty()) {
      ::unsetenv("TMPDIR");
    } else {
      ::setenv("TMPDIR", old_.c_str(), 1);
    }
  }

 private:
  std::string old_;
};

TEST(TrajectoryStore, RowsComeBackAsTheyWere) {
  TrajectoryStore store;
  constexpr std::int64_t count = 5'000;
  for (std::int64_t i = 0; i < count; ++i) store.append(row(i));
  ASSERT_TRUE(store.flush());
  EXPECT_EQ(store.size(), 5'000u);
  const auto rows = store.read(0, 5'000);
  ASSERT_EQ(rows.size(), 5'000u);
  for (std::int64_t i = 0; i < count; ++i) expect_row(rows[static_cast<std::size_t>(i)], i);
}

TEST(TrajectoryStore, AnyRangeMayBeReadAndIsShorterAtTheEnd) {
  TrajectoryStore store;
  EXPECT_TRUE(store.read(0, 10).empty());
  for (int i = 0; i < 10; ++i) store.append(row(i));
  ASSERT_TRUE(store.flush());
  const auto middle = store.read(4, 3);
  ASSERT_EQ(middle.size(), 3u);
  expect_row(middle[0], 4);
  EXPECT_EQ(store.read(8, 100).size(), 2u);
  EXPECT_TRUE(store.read(10, 1).empty());
  EXPECT_TRUE(store.read(1'000'000, 1).empty());
}

TEST(TrajectoryStore, MoreMayBeAppendedAfterReading) {
  TrajectoryStore store;
  store.append(row(0));
  ASSERT_TRUE(store.flush());
  EXPECT_EQ(store.read(0, 9).size(), 1u);
  store.append(row(1));
  ASSERT_TRUE(store.flush());
  const auto rows = store.read(0, 9);
  ASSERT_EQ(rows.size(), 2u);
  expect_row(rows[1], 1);
}

TEST(TrajectoryStore, AReaderOfAnotherThreadSeesWholeRowsWhileTheWriterGoesOn) {
  TrajectoryStore store;
  std::atomic<bool> done = false;
  std::thread writer([&] {
    for (std::int64_t i = 0; i < 100'000; ++i) store.append(row(i));
    store.flush();
    done = true;
  });
  std::size_t seen = 0;
  while (true) {
    const bool last = done;
    const auto rows = store.read(seen, 4096);
    for (std::size_t i = 0; i < rows.size(); ++i) {
      ASSERT_EQ(rows[i].utime, 1'000 * static_cast<std::int64_t>(seen + i));
    }
    seen += rows.size();
    if (last && rows.empty()) break;
  }
  writer.join();
  EXPECT_EQ(seen, 100'000u);
}

TEST(TrajectoryStore, ReadsRowsAsTheyWereCorrectedLast) {
  TrajectoryStore store;
  for (std::int64_t i = 0; i < 10; ++i) store.append(row(i));
  store.flush();
  for (const double x : {1.0, 2.0}) store.correct({4, PatchId{77}, {x, 0, 0}});
  store.correct({9, PatchId{78}, {}});
  const std::vector<TrajectoryRow> rows = store.read(3, 3);
  ASSERT_EQ(rows.size(), 3U);
  expect_row(rows[0], 3);
  EXPECT_EQ(rows[1].patch, PatchId{77});
  EXPECT_EQ(rows[1].patch_from_robot.x, 2);
  EXPECT_EQ(rows[1].utime, row(4).utime) << "where it was, but not when";
  expect_row(rows[2], 5);
  EXPECT_EQ(store.corrections().size(), 2U);
}

TEST(TrajectoryStore, ItsFileIsInTmpdirAndHasNoName) {
  const testing::TemporaryDirectory directory;
  const TmpdirIs tmpdir(directory.path());
  TrajectoryStore store;
  store.append(row(0));
  EXPECT_TRUE(store.flush());
  EXPECT_TRUE(std::filesystem::is_empty(directory.path()));
}

TEST(TrajectoryStore, AMissingTmpdirIsAnErrorThatNamesIt) {
  const TmpdirIs tmpdir("/nowhere/at/all");
  try {
    TrajectoryStore store;
    FAIL() << "no error";
  } catch (const std::runtime_error& error) {
    EXPECT_NE(std::string(error.what()).find("/nowhere/at/all"), std::string::npos) << error.what();
  }
}

}  // namespace
}  // namespace isthmus
