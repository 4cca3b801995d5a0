#pragma once

#include <algorithm>
#include <cstddef>
#include <vector>

#include "patches/ids.hpp"

namespace isthmus {

/// Disjoint sets as a tree of parents, by member: at first each member is its own. A set's name is its lowest
/// member, whatever the order of joining; boost::disjoint_sets names a set by rank.
template <class Member>
class DisjointSets {
 public:
  /// Works on parents that are kept elsewhere.
  explicit DisjointSets(std::vector<Member>& parents) : parents_(parents) {}

  /// The set's lowest member; the way there is shortened.
  Member lowest(Member member) {
    while (parent(member) != member) member = parent(member) = parent(parent(member));
    return member;
  }

  void join(Member a, Member b) {
    const Member lowest_a = lowest(a);
    const Member lowest_b = lowest(b);
    parent(std::max(lowest_a, lowest_b)) = std::min(lowest_a, lowest_b);
  }

 private:
  static std::size_t place(int member) { return static_cast<std::size_t>(member); }
  static std::size_t place(PatchId member) { return static_cast<std::size_t>(member.value); }
  Member& parent(Member member) { return parents_[place(member)]; }

  std::vector<Member>& parents_;
};

}  // namespace isthmus
