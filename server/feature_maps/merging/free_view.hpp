#pragma once

#include <tuple>
#include <vector>

#include "patches/scan.hpp"
#include "server/feature_maps/merging/merging_options.hpp"

namespace isthmus {

/// How far a robot saw from one place.
struct FreeView {
  Pose map_from_laser;
  std::vector<float> hit_m;  ///< m to the nearest thing, by sectors of one width from the laser's x axis on,
                             ///< counter-clockwise; 0: not known

  auto members() { return std::tie(map_from_laser, hit_m); }
};

/// Of a scan. What brings no return tells nothing.
FreeView view_of(const Scan& scan, const Laser& laser, const Pose& map_from_robot, std::size_t sectors);

/// Whether there is one from nearly the same place already.
bool is_seen_from(const std::vector<FreeView>& views, const Pose& map_from_laser,
                  const MergingOptions& options);

}  // namespace isthmus
