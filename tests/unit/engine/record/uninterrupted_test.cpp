#include "server/engine/record/uninterrupted.hpp"

#include <gtest/gtest.h>

namespace isthmus {
namespace {

TEST(Uninterrupted, RepeatsACallThatASignalInterrupted) {
  int calls = 0;
  const int result = uninterrupted([&] {
    if (++calls == 3) return 7;
    errno = EINTR;
    return -1;
  });
  EXPECT_EQ(result, 7);
  EXPECT_EQ(calls, 3);
}

TEST(Uninterrupted, ReturnsEveryOtherErrorAtOnce) {
  int calls = 0;
  const int result = uninterrupted([&] {
    ++calls;
    errno = ENOSPC;
    return -1;
  });
  EXPECT_EQ(result, -1);
  EXPECT_EQ(errno, ENOSPC);
  EXPECT_EQ(calls, 1);
}

}  // namespace
}  // namespace isthmus
