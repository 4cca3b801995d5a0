#include "tools/simulate/run/sighting_model.hpp"

#include <algorithm>
#include <cmath>

namespace isthmus {

TrueSighting true_sighting(const Pose& world_from_observer, const Eigen::Vector2d& target, int barcode) {
  const Eigen::Vector2d seen = inverse(world_from_observer) * target;
  return {barcode, seen.norm(), std::atan2(seen.y(), seen.x())};
}

bool in_sight(const CameraPlan& plan, const RayCaster& caster, const Pose& world_from_observer,
              const Eigen::Vector2d& target) {
  const TrueSighting truth = true_sighting(world_from_observer, target, 0);
  return truth.range_m <= plan.range_max_m && std::abs(truth.bearing_rad) <= 0.5 * plan.field_of_view_rad &&
         caster.line_of_sight({world_from_observer.x, world_from_observer.y}, target);
}

SightingEvent measure(const CameraPlan& plan, const TrueSighting& truth, Random& random) {
  SightingEvent sighting;
  sighting.barcode = truth.barcode;
  sighting.range_m = std::max(0.01, truth.range_m + random.normal(plan.range_sigma_m));
  sighting.range_sigma_m = plan.range_sigma_m;
  sighting.bearing_rad = wrap_angle(truth.bearing_rad + random.normal(plan.bearing_sigma_rad));
  sighting.bearing_sigma_rad = plan.bearing_sigma_rad;
  return sighting;
}

std::string falsify(SightingEvent& sighting, const std::vector<int>& other_barcodes, Random& random) {
  if (random.chance(0.5)) {
    std::vector<int> wrong;
    std::ranges::copy_if(other_barcodes, std::back_inserter(wrong),
                         [&](int barcode) { return barcode != sighting.barcode; });
    wrong.push_back(std::max(sighting.barcode, *std::ranges::max_element(other_barcodes)) + 90);
    sighting.barcode = wrong[random.index(wrong.size())];
    return "wrong_id";
  }
  const std::size_t what = random.index(3);
  if (what != 1) {
    const double off = random.uniform(1.1, 4);
    sighting.range_m += sighting.range_m > off + 0.2 && random.chance(0.5) ? -off : off;
  }
  if (what != 0) {
    const double off = random.uniform(0.4, std::numbers::pi);
    sighting.bearing_rad = wrap_angle(sighting.bearing_rad + (random.chance(0.5) ? off : -off));
  }
  return "gross";
}

}  // namespace isthmus
