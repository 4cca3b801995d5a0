#include "server/engine/places/consistency.hpp"

#include <gtest/gtest.h>
#include <rapidcheck.h>

#include <algorithm>

namespace isthmus {
namespace {

AgreementTable any_table(std::size_t size) {
  AgreementTable table;
  for (std::size_t i = 0; i < size; ++i) {
    std::vector<Agreement> row;
    for (std::size_t j = 0; j < i; ++j)
      row.push_back(*rc::gen::element(Agreement::consistent, Agreement::inconsistent, Agreement::unrelated));
    table.add(std::move(row));
  }
  return table;
}

bool is_consistent(const AgreementTable& table, const std::vector<std::size_t>& set) {
  return std::ranges::all_of(set, [&](std::size_t a) {
    return std::ranges::all_of(set,
                               [&](std::size_t b) { return table.between(a, b) == Agreement::consistent; });
  });
}

TEST(AgreementTableProperty, TheSetIsPairwiseConsistentAndNoLargerOneHoldsTheMember) {
  EXPECT_TRUE(rc::check([] {
    const auto size = *rc::gen::inRange<std::size_t>(1, 11);
    const AgreementTable table = any_table(size);
    const auto member = *rc::gen::inRange<std::size_t>(0, size);
    const std::vector<std::size_t> set = table.largest_consistent_with(member, {});
    RC_ASSERT(std::ranges::find(set, member) != set.end());
    RC_ASSERT(is_consistent(table, set));
    for (std::size_t bits = 0; bits < (std::size_t{1} << size); ++bits) {
      if (!(bits >> member & 1)) continue;
      std::vector<std::size_t> other;
      for (std::size_t i = 0; i < size; ++i)
        if (bits >> i & 1) other.push_back(i);
      RC_ASSERT(other.size() <= set.size() || !is_consistent(table, other));
    }
  }));
}

TEST(AgreementTableProperty, WhatLeavesDoesNotChangeTheRest) {
  EXPECT_TRUE(rc::check([] {
    const auto size = *rc::gen::inRange<std::size_t>(1, 12);
    AgreementTable table = any_table(size);
    const AgreementTable before = table;
    std::vector<bool> gone;
    std::vector<std::size_t> kept;
    for (std::size_t i = 0; i < size; ++i) {
      gone.push_back(*rc::gen::arbitrary<bool>());
      if (!gone[i]) kept.push_back(i);
    }
    table.remove(gone);
    RC_ASSERT(table.size() == kept.size());
    for (std::size_t i = 0; i < kept.size(); ++i)
      for (std::size_t j = 0; j < kept.size(); ++j)
        RC_ASSERT(table.between(i, j) == before.between(kept[i], kept[j]));
  }));
}

}  // namespace
}  // namespace isthmus
