#include "server/wire/page/texts/bulletin.hpp"

#include <gtest/gtest.h>

#include <thread>

namespace isthmus {
namespace {

using std::chrono::milliseconds;

TEST(Bulletin, AViewerIsToldTheNewestOfEachTopicOnce) {
  Bulletin bulletin;
  bulletin.post("status", "1");
  bulletin.post("robots", "a");
  bulletin.post("robots", "b");
  Bulletin::Cursor cursor;
  EXPECT_EQ(bulletin.next(cursor, milliseconds(0)), "event: robots\ndata: b\n\nevent: status\ndata: 1\n\n");
  EXPECT_EQ(bulletin.next(cursor, milliseconds(0)), "");
  bulletin.post("status", "1");
  EXPECT_EQ(bulletin.next(cursor, milliseconds(0)), "") << "the text there was";
  bulletin.post("status", "2");
  EXPECT_EQ(bulletin.next(cursor, milliseconds(0)), "event: status\ndata: 2\n\n");
  Bulletin::Cursor late;
  EXPECT_EQ(bulletin.next(late, milliseconds(0)), "event: robots\ndata: b\n\nevent: status\ndata: 2\n\n");
}

TEST(Bulletin, OneThatWaitsIsTold) {
  Bulletin bulletin;
  Bulletin::Cursor cursor;
  std::jthread poster([&] { bulletin.post("status", "1"); });
  EXPECT_EQ(bulletin.next(cursor, std::chrono::hours(1)), "event: status\ndata: 1\n\n");
}

TEST(Bulletin, OneThatWaitsEndsWhenItIsClosed) {
  Bulletin bulletin;
  Bulletin::Cursor cursor;
  std::jthread closer([&] { bulletin.close(); });
  EXPECT_EQ(bulletin.next(cursor, std::chrono::hours(1)), std::nullopt);
}

}  // namespace
}  // namespace isthmus
