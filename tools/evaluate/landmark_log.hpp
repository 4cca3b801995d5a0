#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "patches/pose.hpp"

namespace isthmus {

/// A landmark seen from a pose: its place in that pose's frame, in metres, with its covariance.
struct LandmarkSighting {
  int landmark = 0;  ///< index into LandmarkLog::landmark_ids
  Eigen::Vector2d place = Eigen::Vector2d::Zero();
  Eigen::Matrix2d covariance = Eigen::Matrix2d::Identity();
};

/// One step of the robot: how it moved, then what it saw. The first step has no odometry.
struct LandmarkStep {
  Pose old_from_new;
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();  ///< of its (x, y, yaw)
  std::vector<LandmarkSighting> sightings;
};

struct LandmarkLog {
  std::vector<LandmarkStep> steps;
  std::vector<long> landmark_ids;  ///< as in the file, in order of their first sighting
};

/// Reads a log of iSAM's form (Kaess), plain or gz, in order of its lines: `ODOMETRY` or `EDGE2 i j x y yaw`
/// from the pose reached last to a new one, `LANDMARK i l x y` from the pose reached last; each with the
/// upper triangle of the square root of its information, row by row. Throws FileError naming file, line and
/// reason.
LandmarkLog read_landmark_log(const std::string& file);

/// Poses and landmarks that a log without noise tells exactly, the first pose at the origin; a landmark by
/// its first sighting.
struct LandmarkTruth {
  std::vector<Pose> poses;
  std::vector<Eigen::Vector2d> landmarks;
};
LandmarkTruth true_map(const LandmarkLog& exact);

/// The log as it might have been recorded: exact values with fresh noise of the given covariances, drawn from
/// a seed.
LandmarkLog with_noise(const LandmarkLog& exact, std::uint64_t seed);

}  // namespace isthmus
