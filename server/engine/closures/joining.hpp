#pragma once

#include <Eigen/Core>
#include <tuple>

#include "patches/ids.hpp"
#include "patches/pose.hpp"

namespace isthmus {

class Map;
struct EngineOptions;

/// What a closure says, by whatever it was found: how a patch of one side lies to one of the other.
struct Joining {
  PatchId first;
  PatchId second;
  Pose first_from_second;
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();  ///< of that; m and rad
  bool point = false;  ///< `second` is a fixed tag's: a place without a heading

  auto members() { return std::tie(first, second, first_from_second, covariance, point); }
};

/// The patch, or where it is a fixed tag, which has no heading, one that is related to it.
PatchId ground_of(const Map& map, PatchId patch);

/// The same joining as a map has it that holds it. Where it is on two islands, or relations leave it
/// undetermined, it stays as it is.
Joining as_mapped(const Map& map, Joining joining);

/// Whether a map that something has been tried out on, `tried`, brings about a joining that `map` has not:
/// its ends come to lie as it says, as far as is known. How far that is follows from how well the joining
/// was known and from how well the trial knows its ends relative to one another: they may have drifted since,
/// what joins them may be far from them or a third island.
bool brings_about(const Map& map, const Map& tried, const Joining& joining, const EngineOptions& options);

}  // namespace isthmus
