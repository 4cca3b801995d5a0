#include <gtest/gtest.h>
#include <rapidcheck.h>

#include <limits>
#include <map>

#include "relations/weakest_cut.hpp"

namespace isthmus {
namespace {

constexpr int patch_count = 6;

/// Random links between few patches, some of them of placings, which are always by older patches.
std::vector<UncertainLink> random_links() {
  std::vector<UncertainLink> links;
  for (const int number : *rc::gen::container<std::vector<int>>(rc::gen::inRange(0, 100'000))) {
    const int a = number % patch_count, b = number / patch_count % patch_count;
    if (a == b) continue;
    const bool of_placing = number / 36 % 2 == 0;
    const double log_odds = 1 + number / 72 % 9;
    links.push_back({RelationId{static_cast<std::int32_t>(links.size())}, PatchId{std::min(a, b)},
                     PatchId{std::max(a, b)}, log_odds, of_placing});
  }
  return links;
}

/// What it costs that just these patches lie beyond: each link by itself, of a placing either the least sure
/// of its links and those on this side, or those on the other side, whichever is less.
double cost(const std::vector<UncertainLink>& links, unsigned beyond) {
  const auto is_beyond = [&](PatchId id) { return (beyond >> static_cast<unsigned>(id.value) & 1U) != 0; };
  double sum = 0;
  struct Placing {
    double here = 0, there = 0;
    double least = std::numeric_limits<double>::infinity();
  };
  std::map<PatchId, Placing> placings;
  for (const UncertainLink& link : links) {
    const bool parted = is_beyond(link.a) != is_beyond(link.b);
    if (!link.of_placing) {
      sum += parted ? link.log_odds : 0;
    } else {
      Placing& placing = placings[link.b];
      (parted ? placing.there : placing.here) += link.log_odds;
      placing.least = std::min(placing.least, link.log_odds);
    }
  }
  for (const auto& [placed, its] : placings) sum += std::min(its.there, its.least + its.here);
  return sum;
}

TEST(WeakestCutProperty, CostsNoMoreThanAnyOtherPartingOfAllPatches) {
  EXPECT_TRUE(rc::check([] {
    const std::vector<UncertainLink> links = random_links();
    const PatchId from{0}, to{1};
    double least = std::numeric_limits<double>::infinity();
    for (unsigned beyond = 0; beyond < 1U << patch_count; ++beyond)
      if ((beyond & 3U) == 2U) least = std::min(least, cost(links, beyond));
    const auto found = weakest_cut(links, std::span(&from, 1), std::span(&to, 1));
    if (!found) {
      // One of the two has no link, or nothing connects them.
      RC_ASSERT(least == 0);
      return;
    }
    RC_ASSERT(std::abs(found->log_odds - least) < 1e-9);
    unsigned beyond = 0;
    for (const PatchId id : found->beyond) beyond |= 1U << static_cast<unsigned>(id.value);
    RC_ASSERT(std::abs(cost(links, beyond) - least) < 1e-9);
  }));
}

}  // namespace
}  // namespace isthmus
