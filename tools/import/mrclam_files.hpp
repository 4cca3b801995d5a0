#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "patches/pose.hpp"

namespace isthmus {

/// The text files of a UTIAS MRCLAM set (Leung et al., IJRR 2011), each NAME.dat or NAME.dat.gz. Subjects 1
/// to 5 are robots, those from 6 on are landmarks. Readers throw FileError naming file, line and reason.

constexpr int last_mrclam_robot = 5;

/// A line of RobotN_Odometry: the velocities that the robot is told to keep from now on.
struct VelocityLine {
  std::int64_t utime = 0;
  double forward_m_s = 0;
  double turn_rad_s = 0;
};

/// A line of RobotN_Measurement.
struct MeasurementLine {
  std::int64_t utime = 0;
  std::int32_t barcode = 0;
  double range_m = 0;
  double bearing_rad = 0;
};

/// A line of RobotN_Groundtruth.
struct TruthLine {
  std::int64_t utime = 0;
  Pose world_from_robot;
};

/// The path of DIRECTORY/NAME.dat or of DIRECTORY/NAME.dat.gz; empty where there is neither.
std::string find_mrclam_file(const std::string& directory, const std::string& name);
/// The same for a file that must be there.
std::string mrclam_file(const std::string& directory, const std::string& name);

/// The subjects from 1 to 5 that have a RobotN_Odometry file; none is an error.
std::vector<int> mrclam_robots(const std::string& directory);

std::map<int, std::int32_t> read_barcodes(const std::string& file);  ///< by subject; each barcode once
std::vector<VelocityLine> read_velocities(const std::string& file);
std::vector<MeasurementLine> read_measurements(const std::string& file);
std::vector<TruthLine> read_robot_truth(const std::string& file);
std::map<int, Eigen::Vector2d> read_landmark_truth(const std::string& file);  ///< by subject

}  // namespace isthmus
