#include "server/client/goal.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "server/client/poses.hpp"
#include "server/wire/message/byte_check.hpp"
#include "server/wire/message/members.hpp"

namespace isthmus {
namespace {

using members::integer;
using members::name;
using members::number;
using members::pose_values;

constexpr Member flag = fixed(1);
constexpr std::array goal_members = {
    number,      number,  name,        name, integer,
    number,      integer, pose_values, flag, integer,
    pose_values, number,  number,      flag, list(members::path_pose, max_poses)};

bool all_finite(const path_pose_t& pose) {
  const auto finite = [](double value) { return std::isfinite(value); };
  return std::ranges::all_of(pose.patch_from_robot, finite) &&
         std::ranges::all_of(pose.map_from_robot, finite);
}

}  // namespace

std::optional<goal_t> read_goal(std::span<const std::uint8_t> bytes) {
  if (check_bytes(goal_t::getHash(), goal_members, bytes) != DropReason::none) return std::nullopt;
  goal_t goal;
  const int size = static_cast<int>(bytes.size());
  if (goal.decode(bytes.data(), 0, size) != size) return std::nullopt;
  if (!all_finite(goal.pose) || !all_finite(goal.goal) || !std::ranges::all_of(goal.poses, all_finite))
    return std::nullopt;
  return goal;
}

}  // namespace isthmus
