#include "server/program/finite_number.hpp"

#include <gtest/gtest.h>

namespace isthmus {
namespace {

bool takes(std::string text) { return (finite_number & CLI::Range(-10.0, 10.0))(text).empty(); }

TEST(FiniteNumber, IsNeitherNanNorInfiniteAndInItsRange) {
  for (const char* right : {"0", "-2.5", "1e1"}) EXPECT_TRUE(takes(right)) << right;
  for (const char* wrong : {"nan", "-nan", "NAN", "inf", "-inf", "11", "two", ""})
    EXPECT_FALSE(takes(wrong)) << wrong;
}

}  // namespace
}  // namespace isthmus
