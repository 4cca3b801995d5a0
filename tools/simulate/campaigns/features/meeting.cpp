#include "tools/simulate/campaigns/features/meeting.hpp"

#include <cmath>

namespace isthmus {

RobotAlignment align_at_meeting(const Pose& one_from_two, Random random) {
  const Pose back = inverse(one_from_two);
  const double range = std::hypot(one_from_two.x, one_from_two.y);
  MutualSighting sighting;
  sighting.range_1_sigma_m = sighting.range_2_sigma_m = 0.02;
  sighting.bearing_1_sigma_rad = sighting.bearing_2_sigma_rad = 0.07;
  sighting.range_1_m = range + random.normal(0.02);
  sighting.range_2_m = range + random.normal(0.02);
  sighting.bearing_1_rad = std::atan2(one_from_two.y, one_from_two.x) + random.normal(0.07);
  sighting.bearing_2_rad = std::atan2(back.y, back.x) + random.normal(0.07);
  return align_robots(sighting);
}

}  // namespace isthmus
