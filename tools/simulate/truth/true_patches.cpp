#include "tools/simulate/truth/true_patches.hpp"

#include <map>
#include <string>
#include <utility>

namespace isthmus {

std::vector<std::optional<TruePatch>> true_patches(const MapCopy& map, const std::vector<RobotTruth>& truth) {
  std::map<std::pair<std::string, std::int64_t>, TruePatch> by_stamp;
  for (std::size_t robot = 0; robot < truth.size(); ++robot) {
    for (const TruePose& pose : truth[robot].poses) {
      by_stamp[{truth[robot].robot, pose.utime}] = {robot, pose.stretch, pose.world_from_robot};
    }
  }
  std::vector<std::optional<TruePatch>> patches;
  for (const PatchPtr& patch : map.patches) {
    const auto at = by_stamp.find({patch->robot, patch->utime});
    patches.push_back(at == by_stamp.end() ? std::nullopt : std::optional(at->second));
  }
  return patches;
}

}  // namespace isthmus
