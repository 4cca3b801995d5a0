#pragma once

#include <optional>
#include <string>
#include <vector>

#include "server/features/options.hpp"
#include "tools/evaluate/landmark_log.hpp"

namespace isthmus {

/// How the filter learns which landmark is which.
enum class LandmarkAssociation { known, joint, nearest };

/// What one estimator made of a log.
struct LandmarkMap {
  std::vector<Pose> poses;  ///< each when it was reached (filter), or after all (batch fit)
  /// By index; nothing where the estimator has none. Where the filter associated by itself: the place of the
  /// feature that most of the landmark's sightings were taken for.
  std::vector<std::optional<Eigen::Vector2d>> landmarks;
  std::vector<double> nees;        ///< of each pose over its 3 degrees of freedom, where there is a truth
  double chi_squared_per_dof = 0;  ///< of the batch fit
  std::size_t features = 0;        ///< in the filter's state at the end
  std::size_t wrong_pairs = 0;     ///< sightings taken for a feature that another landmark began
  double cpu_s = 0;
  std::string failure;  ///< why there is no solution; empty: there is
};

LandmarkMap filter_landmarks(const LandmarkLog& log, FilterForm form, LandmarkAssociation association,
                             const LandmarkTruth* truth);

/// All relations in one fit, by `relations`, from a map near the optimum (odometry alone leads it astray);
/// landmarks are patches of which only the position is measured.
LandmarkMap fit_landmarks(const LandmarkLog& log, const LandmarkMap& start);

/// Errors of an estimator's map.
struct LandmarkErrors {
  double pose_rmse_m = 0;
  double pose_rmse_deg = 0;
  double nees_per_dof = 0;        ///< mean over all poses; 0 without a truth
  double landmark_rmse_m = 0;     ///< of the landmarks it has, in the frame of the first pose
  double landmark_aligned_m = 0;  ///< after the rigid motion of least squared distance
  std::size_t landmarks = 0;
};
LandmarkErrors landmark_errors(const LandmarkMap& map, const LandmarkTruth& truth);

/// What isthmus-evaluate --landmarks prints.
struct LandmarkEvaluation {
  struct Row {
    std::string name;  ///< invariant, printed, batch
    LandmarkMap map;
    LandmarkErrors errors;
  };
  std::size_t poses = 0;
  std::size_t landmarks = 0;
  std::size_t sightings = 0;
  bool against_batch = false;  ///< there is no truth: errors are against the batch fit
  std::vector<Row> rows;
  struct FreshNoise {
    std::string name;
    double nees_per_dof = 0;
    double pose_rmse_m = 0;
    double pose_rmse_deg = 0;
  };
  std::size_t noises = 0;
  std::vector<FreshNoise> fresh;  ///< means over `noises` runs
};

struct LandmarkArguments {
  std::string file;
  std::string truth;  ///< a log without noise; empty: none
  LandmarkAssociation association = LandmarkAssociation::known;
  std::size_t noises = 0;  ///< runs with fresh noise on the truth, of both forms
};

/// Throws FileError naming file, line and reason; also where the truth is not of the same poses and
/// sightings.
LandmarkEvaluation evaluate_landmarks(const LandmarkArguments& arguments);

}  // namespace isthmus
