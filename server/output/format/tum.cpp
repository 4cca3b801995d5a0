#include "server/output/format/tum.hpp"

#include <cmath>

#include "server/output/format/number.hpp"

namespace isthmus {

std::string tum_line(std::int64_t utime, const Pose& map_from_robot) {
  const Pose& pose = map_from_robot;
  return seconds(utime) + ' ' + fixed(pose.x, 6) + ' ' + fixed(pose.y, 6) + " 0 0 0 " +
         fixed(std::sin(0.5 * pose.yaw), 9) + ' ' + fixed(std::cos(0.5 * pose.yaw), 9) + '\n';
}

}  // namespace isthmus
