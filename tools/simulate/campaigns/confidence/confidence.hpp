#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "relations/mount_survey.hpp"
#include "server/engine/input/configuration.hpp"
#include "server/engine/record/map_copy.hpp"
#include "tools/simulate/run/simulation.hpp"

namespace isthmus {

/// How often the truth lies where a map's covariances say.
struct Confidence {
  std::size_t pairs = 0;
  std::array<double, 3> within_95 = {};  ///< share of pairs whose x, y, yaw error is at most 1.96 sigma
  double mean_nees = 0;                  ///< normalised estimation error squared, per degree of freedom
  double median_nees = 0;                ///< 0.79 where errors are Gaussian and covariances true
  double mean_error_m = 0;
  double mean_error_rad = 0;
};

/// Collects errors of relative poses and what was said of them.
class ConfidenceTally {
 public:
  /// `error`: estimate less truth, of (x, y, yaw) of a_from_b.
  void add(const Eigen::Vector3d& error, const Eigen::Matrix3d& covariance);
  void add(const ConfidenceTally& other);
  Confidence result() const;

 private:
  std::vector<double> nees_;
  std::array<std::size_t, 3> within_ = {};
  double error_m_ = 0;
  double error_rad_ = 0;
};

/// Relative poses of patches against the truth.
struct MapConfidence {
  ConfidenceTally local;         ///< b in a's local map: near, and well determined (eq. 12)
  ConfidenceTally island;        ///< b anywhere on a's island
  std::size_t undetermined = 0;  ///< patches a for which no covariances could be had
};

/// Judges a map built from a run, from about `observers` of its patches. `survey`: how well the run's robots
/// know where their lasers are.
MapConfidence judge_confidence(const MapCopy& map, const std::vector<RobotTruth>& truth,
                               const EngineOptions& options, const MountSurvey& survey,
                               std::size_t observers = 30);

/// The map that an engine makes of events, as a server hears them: to the bit that of their log, replayed.
/// Angles come as f32 in messages, and on the edge of a decision the ninth digit of one makes another map.
MapCopy map_events(const std::vector<Event>& events, const Configuration& configuration = {});

}  // namespace isthmus
