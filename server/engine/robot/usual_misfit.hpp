#pragma once

#include <tuple>

#include "server/engine/input/options/robot_options.hpp"

namespace isthmus {

/// How badly a robot's scans usually fit where they belong: by how much their scores are less than 1. Of
/// 45,000 scans of five recorded drives one in 50 is worse than twice the mean before it, one in 500 than
/// three times.
class UsualMisfit {
 public:
  /// A scan was matched where odometry left no doubt; `score` as in MatchQuality.
  void learn(double score, const UsualMisfitOptions& options);

  /// The least score of a scan where it belongs, but for `rare_share` of them, were misfits exponentially
  /// distributed. Less than 0 before much was learned.
  double least_score(const UsualMisfitOptions& options) const;

  auto members() { return std::tie(mean_, scans_); }

 private:
  double mean_ = 1;
  double scans_ = 1;  // that it is the mean of; the first is no scan's, and fits nothing
};

}  // namespace isthmus
