#pragma once

#include <Eigen/Core>

#include "patches/pose.hpp"
#include "server/engine/input/options/place_options.hpp"

namespace isthmus {

/// What maps err beyond their covariance, by the way between two patches: no sensor errs at random only, and
/// what errs the same way all along adds up. Variances of x, y (m²) and yaw (rad²).
Eigen::Vector3d systematic_variance(double way_m, const PlaceCandidateOptions& options);

/// What a map may be off by however sure it is of itself, for a slip leaves a relation as narrow as any
/// other: variances that make the bounds of drift `window_sigmas` standard deviations.
Eigen::Vector3d drift_variance(double way_m, const PlaceCandidateOptions& options);

/// Logarithm of the volume (m² rad) of the window that is searched over so much way.
double log_search_window(double way_m, const PlaceCandidateOptions& options);

/// Log-odds that a map drifted so far, without a slip, rather than that it is off by anything in the window
/// that is searched: by a pose as it was found and as the map has it with this covariance (x, y, yaw), over
/// so much way.
double drift_log_odds(const Pose& found, const Pose& mapped, const Eigen::Matrix3d& covariance, double way_m,
                      const PlaceCandidateOptions& options);

/// Log-odds that a robot came back to where it was found, rather than that another place looks like it: had
/// it come back, the map is off by what maps err by, and once in a while, where wheels slipped, by anything;
/// a place that only looks alike may be anywhere in the window that was searched.
double revisit_log_odds(const Pose& found, const Pose& mapped, const Eigen::Matrix3d& covariance,
                        double way_m, const PlaceCandidateOptions& options);

}  // namespace isthmus
