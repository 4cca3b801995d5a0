#pragma once

#include <optional>
#include <string>
#include <vector>

#include "server/engine/input/event.hpp"
#include "tools/simulate/plan/random.hpp"
#include "tools/simulate/run/ray_caster.hpp"
#include "tools/simulate/scenario/scenario.hpp"

namespace isthmus {

/// What there truly is between an observer's base and a target.
struct TrueSighting {
  int barcode = -1;
  double range_m = 0;
  double bearing_rad = 0;
};

TrueSighting true_sighting(const Pose& world_from_observer, const Eigen::Vector2d& target, int barcode);

/// Whether a camera can read a barcode there: within range and field of view, and nothing in between.
bool in_sight(const CameraPlan& plan, const RayCaster& caster, const Pose& world_from_observer,
              const Eigen::Vector2d& target);

/// A reading of a barcode in sight, with noise; robot and utime are left to the caller.
SightingEvent measure(const CameraPlan& plan, const TrueSighting& truth, Random& random);

/// Spoils a reading: "wrong_id", one of `other_barcodes` that is not the true one, or one that nobody wears;
/// or "gross", off by 1 to 4 m or by 20 to 180 degrees, or both. Returns which.
std::string falsify(SightingEvent& sighting, const std::vector<int>& other_barcodes, Random& random);

}  // namespace isthmus
