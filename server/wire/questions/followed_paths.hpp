#pragma once

#include <chrono>
#include <cstdint>
#include <string>
#include <vector>

#include "isthmus/reply_t.hpp"
#include "server/wire/questions/question.hpp"

namespace isthmus {

/// A path that somebody drives, and is told about.
struct FollowedPath {
  using Clock = std::chrono::steady_clock;

  Question question;
  std::string asker;  ///< as questions are counted by
  Clock::time_point end;
  reply_t told;             ///< the last
  std::int64_t looked = 0;  ///< number of the map that it was looked at on

  /// A reply becomes the next one told.
  void number(reply_t& reply, bool followed);
  /// The last reply: that it is not followed any more.
  reply_t last(FollowEnd why);
};

/// The paths that are followed, bounded in number.
class FollowedPaths {
 public:
  using Clock = FollowedPath::Clock;

  FollowedPaths(std::size_t max, std::size_t max_of_asker) : max_(max), max_of_asker_(max_of_asker) {}

  bool empty() const { return paths_.empty(); }
  bool has_room(const std::string& asker) const;
  void add(FollowedPath path) { paths_.push_back(std::move(path)); }

  /// Those that are not followed any more.
  std::vector<FollowedPath> take(const std::string& asker, std::int64_t request_id);
  std::vector<FollowedPath> take_ended(Clock::time_point now);
  std::vector<FollowedPath> take_all() { return std::exchange(paths_, {}); }

  /// One that was not looked at on this map: looked at it is now; nothing: all were. Each gets its turn.
  FollowedPath* next(std::int64_t map);
  void erase(const FollowedPath* path);

 private:
  std::size_t max_, max_of_asker_;
  std::vector<FollowedPath> paths_;
};

}  // namespace isthmus
