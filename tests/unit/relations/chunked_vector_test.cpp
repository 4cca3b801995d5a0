#include "relations/chunked_vector.hpp"

#include <gtest/gtest.h>

#include <numeric>
#include <string>
#include <thread>

namespace isthmus {
namespace {

using Numbers = ChunkedVector<std::string, 4>;

Numbers count_to(int end) {
  Numbers numbers;
  for (int i = 0; i < end; ++i) numbers.push_back(std::to_string(i));
  return numbers;
}

std::vector<std::string> values(const Numbers& numbers) {
  std::vector<std::string> found;
  for (std::size_t i = 0; i < numbers.size(); ++i) found.push_back(numbers[i]);
  return found;
}

TEST(ChunkedVector, HoldsWhatWasPushedInOrder) {
  EXPECT_TRUE(Numbers().empty());
  EXPECT_EQ(values(count_to(5)), (std::vector<std::string>{"0", "1", "2", "3", "4"}));
}

TEST(ChunkedVector, ACopySharesWhatNeitherHasChanged) {
  const Numbers first = count_to(10);
  Numbers second = first;
  EXPECT_EQ(&second[0], &first[0]);
  second.own(5) = "x";
  EXPECT_EQ(&second[0], &first[0]) << "another chunk";
  EXPECT_NE(&second[4], &first[4]) << "the same chunk";
}

TEST(ChunkedVector, WhatOneCopyChangesTheOthersDoNotSee) {
  Numbers first = count_to(10);
  Numbers second = first;
  Numbers third = second;
  second.own(5) = "x";
  second.push_back("10");
  first.own(9) = "y";
  EXPECT_EQ(values(third), values(count_to(10)));
  EXPECT_EQ(second[5], "x");
  EXPECT_EQ(second.size(), 11U);
  EXPECT_EQ(second[9], "9");
  EXPECT_EQ(first[5], "5");
  EXPECT_EQ(first.size(), 10U);
}

TEST(ChunkedVector, IsCopiedNoMoreOnceItIsTheOnlyOwner) {
  Numbers first = count_to(4);
  const std::string* before = &first[0];
  { const Numbers gone = first; }
  first.own(0) = "x";
  EXPECT_EQ(&first[0], before);
}

// A copy goes to another thread, as that of a map that is fitted beside the engine does.
TEST(ChunkedVector, CopiesAreReadAndLetGoByThreadsWhileTheirOriginChanges) {
  Numbers origin = count_to(100);
  std::vector<std::thread> threads;
  for (int k = 0; k < 4; ++k) {
    threads.emplace_back([copy = origin, k] {
      for (std::size_t i = 0; i < 100; ++i) {
        const std::string expected = static_cast<int>(i) < k ? "x" : std::to_string(i);
        EXPECT_EQ(copy[i], expected);
      }
    });
    origin.own(static_cast<std::size_t>(k)) = "x";
  }
  for (std::thread& thread : threads) thread.join();
  for (std::size_t i = 0; i < 100; ++i) origin.own(i) = "y";
  EXPECT_EQ(origin[99], "y");
}

}  // namespace
}  // namespace isthmus
