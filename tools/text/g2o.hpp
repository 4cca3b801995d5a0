#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "patches/pose.hpp"

namespace isthmus {

/// An EDGE_SE2 line: vertex `to` as measured from vertex `from`, in metres and radians. The information is
/// that of (x, y, yaw) in the axes of the measured pose.
struct G2oFileEdge {
  std::int64_t from = 0;
  std::int64_t to = 0;
  Pose from_to;
  Eigen::Matrix3d information;  ///< symmetric; positive in yaw and positive definite in x and y
  long line = 0;                ///< of the file, from 1
};

struct G2oFile {
  std::map<std::int64_t, std::optional<Pose>> vertices;  ///< by id; no pose for one that only edges name
  std::vector<G2oFileEdge> edges;
};

/// Reads the VERTEX_SE2 and EDGE_SE2 lines of a g2o file, plain or gz; FIX lines and comments (#) are
/// skipped. Throws FileError naming file, line and reason.
G2oFile read_g2o(const std::string& file);

}  // namespace isthmus
