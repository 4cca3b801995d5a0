#pragma once

#include <vector>

#include "isthmus/path_pose_t.hpp"
#include "patches/manifold.hpp"

namespace isthmus {

/// Of a path that is drawn; longer ones are thinned.
inline constexpr std::size_t max_drawn_poses = 500;

ManifoldPose manifold_pose(const path_pose_t& pose);
/// First and last stay.
std::vector<ManifoldPose> thinned(const std::vector<path_pose_t>& path);
/// Rounded; what is no number is no place, and 0.
double to_centimetres(double value);

}  // namespace isthmus
