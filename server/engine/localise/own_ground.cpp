#include "server/engine/localise/own_ground.hpp"

#include <algorithm>
#include <iterator>

namespace isthmus {

OwnGround::OwnGround(const Map& together, const Map& parted) : together_(together), parted_(parted) {
  for (const PatchPtr& patch : parted.manifold().patches())
    if (patch->tag < 0) own_[patch->robot].push_back(patch->id);
  for (auto& [robot, patches] : own_)
    std::ranges::stable_sort(patches, {}, [&](PatchId id) { return parted.manifold().patch(id).utime; });
}

bool OwnGround::put_back(const std::string& robot, PastPlace& place) const {
  const auto its = own_.find(robot);
  if (its == own_.end()) return false;
  const auto after = std::ranges::upper_bound(its->second, place.utime, {},
                                              [&](PatchId id) { return parted_.manifold().patch(id).utime; });
  const PatchId own = after == its->second.begin() ? *after : *std::prev(after);
  const PatchId other = place.pose.patch;
  if (parted_.graph().island(own) == parted_.graph().island(other)) return false;
  if (together_.graph().island(own) != together_.graph().island(other)) return false;
  place.pose = together_.manifold().transform(place.pose, own);  // eq. 3
  return true;
}

}  // namespace isthmus
