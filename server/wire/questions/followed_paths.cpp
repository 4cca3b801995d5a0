#include "server/wire/questions/followed_paths.hpp"

#include <algorithm>
#include <iterator>
#include <utility>

namespace isthmus {
namespace {

/// Takes those out for which `is_taken`, in order.
template <class Taken>
std::vector<FollowedPath> take_if(std::vector<FollowedPath>& paths, const Taken& is_taken) {
  const auto left = std::stable_partition(paths.begin(), paths.end(),
                                          [&](const FollowedPath& path) { return !is_taken(path); });
  std::vector<FollowedPath> taken(std::make_move_iterator(left), std::make_move_iterator(paths.end()));
  paths.erase(left, paths.end());
  return taken;
}

}  // namespace

void FollowedPath::number(reply_t& reply, bool followed) {
  reply.update = told.update + 1;
  reply.followed = followed ? 1 : 0;
  told = reply;
}

reply_t FollowedPath::last(FollowEnd why) {
  reply_t reply = told;  // the path holds as it was told
  reply.change = word(why);
  number(reply, false);
  return reply;
}

bool FollowedPaths::has_room(const std::string& asker) const {
  const auto of_asker = std::ranges::count(paths_, asker, &FollowedPath::asker);
  return paths_.size() < max_ && static_cast<std::size_t>(of_asker) < max_of_asker_;
}

std::vector<FollowedPath> FollowedPaths::take(const std::string& asker, std::int64_t request_id) {
  return take_if(paths_, [&](const FollowedPath& path) {
    return path.asker == asker && path.question.request.id == request_id;
  });
}

std::vector<FollowedPath> FollowedPaths::take_ended(Clock::time_point now) {
  return take_if(paths_, [now](const FollowedPath& path) { return now >= path.end; });
}

FollowedPath* FollowedPaths::next(std::int64_t map) {
  const auto found =
      std::ranges::find_if(paths_, [map](const FollowedPath& path) { return path.looked != map; });
  if (found == paths_.end()) return nullptr;
  std::rotate(found, found + 1, paths_.end());
  paths_.back().looked = map;
  return &paths_.back();
}

void FollowedPaths::erase(const FollowedPath* path) { paths_.erase(paths_.begin() + (path - paths_.data())); }

}  // namespace isthmus
