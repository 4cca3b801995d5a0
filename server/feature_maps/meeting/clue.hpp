#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <tuple>
#include <vector>

#include "patches/pose.hpp"

namespace isthmus {

enum class ClueKind : std::uint8_t {
  seen_from_one,  ///< a robot on the first map saw one on the second
  seen_from_two,  ///< the reverse
  same_place      ///< a fixed barcode that both maps know
};

/// One thing that tells how the second of two maps lies in the first. Covariances are of the estimates in
/// their maps.
struct Clue {
  ClueKind kind = ClueKind::seen_from_one;
  std::int32_t number = -1;  ///< of the input
  int encounter = 0;         ///< clues of one encounter are true or false together
  Pose observer;             ///< in its own map
  Eigen::Matrix3d observer_covariance = Eigen::Matrix3d::Zero();
  Eigen::Vector2d target = Eigen::Vector2d::Zero();  ///< in the other map; of same_place: in the second
  Eigen::Matrix2d target_covariance = Eigen::Matrix2d::Zero();
  Eigen::Vector2d place = Eigen::Vector2d::Zero();  ///< of same_place: in the first map
  Eigen::Matrix2d place_covariance = Eigen::Matrix2d::Zero();
  double target_yaw = 0;  ///< of the robot seen, in its own map
  double range_m = 0;
  double range_sigma_m = 0;  ///< infinity: not measured
  double bearing_rad = 0;
  double bearing_sigma_rad = 0;  ///< infinity: not measured

  auto members() {
    return std::tie(kind, number, encounter, observer, observer_covariance, target, target_covariance, place,
                    place_covariance, target_yaw, range_m, range_sigma_m, bearing_rad, bearing_sigma_rad);
  }
};

/// A clue, and whom it is of.
struct Heard {
  Clue clue;
  int observer = 0;  ///< journeys
  int target = 0;
  std::int64_t utime = 0;
  std::size_t row = 0;       ///< of the sighting
  std::int32_t fusion = -1;  ///< that it speaks for, so far

  auto members() { return std::tie(clue, observer, target, utime, row, fusion); }
};

struct PlacementOptions {
  double true_share = 0.9;  ///< of encounters, and of clues in a true one, that are what they say
  double reach_m = 12;      ///< m within which barcodes are read: a false one is anywhere there
  double same_m = 0.5;      ///< m and rad by which a placing may be off and be the same: duplicates are found
  double same_rad = 0.1;
  double same_sigmas = 4;        ///< or these
  double min_apart_m = 1;        ///< m between two places that tell a heading to begin with
  std::size_t max_starts = 400;  ///< of the search
};

/// Where the second map lies in the first, by all clues together.
struct MapPlacement {
  Pose one_from_two;
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Identity();  ///< of its (x, y, yaw)
  double log_odds = 0;                ///< that it lies there, rather than anywhere else
  std::vector<std::size_t> agreeing;  ///< clues that say so, by index
};

}  // namespace isthmus
