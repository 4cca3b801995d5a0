#pragma once

#include <functional>
#include <tuple>

#include "server/features/association/association.hpp"
#include "server/features/state/measurement.hpp"

namespace isthmus {

/// What became of one scan's features.
struct FeatureScanOutcome {
  struct Pair {
    std::size_t seen = 0;     ///< its place in the scan
    int id = 0;               ///< of the feature
    bool line_alone = false;  ///< of a segment: its ends told nothing
  };
  std::vector<Pair> paired;
  std::vector<Pair> added;    ///< features that are new in the state
  std::size_t unsound = 0;    ///< refused: no feature, or no covariance
  std::size_t tentative = 0;  ///< wait to be seen again
  std::size_t undecided = 0;  ///< near a known feature, but not compatible with the rest
  std::size_t too_many = 0;   ///< `max_features`
};

/// SLAM by features for the robots of one map (Benedettelli et al. 2012, section 3; Zhou and Roumeliotis
/// 2006, algorithm 2): odometry moves a robot, what it sees corrects robots and features alike.
/// Deterministic. A step costs the square of the number of features; beyond `max_features` known ones are
/// corrected and none is added.
class FeatureFilter {
 public:
  explicit FeatureFilter(const FilterOptions& options = {});

  const FeatureState& state() const { return state_; }
  /// For fusion and tests: what is put in must be consistent.
  FeatureState& state() { return state_; }
  const FilterOptions& options() const { return options_; }

  int add_robot(const Pose& map_from_robot, const Eigen::Matrix3d& covariance);
  /// old_from_new with the covariance of its (x, y, yaw). False, and nothing moved, where either is not
  /// finite.
  bool move(int robot, const Pose& old_from_new, const Eigen::Matrix3d& covariance);

  /// What the robot sees where it is, in its frame: paired with the map, the rest waits on the tentative
  /// list.
  FeatureScanOutcome observe(int robot, std::span<const ObservedFeature> seen);

  /// The same where it is known which feature each is; -1 for a new one, which enters the state at once.
  /// Returns the ids, -1 for those refused.
  std::vector<int> observe_known(int robot, std::span<const ObservedFeature> seen, std::span<const int> ids);

  /// Another robot seen; false where it could not be used.
  bool observe_robot(const RelativeSighting& sighting);
  /// Whatever else was measured of the state.
  bool correct_by(const LinearMeasurement& measured) { return correct(state_, {&measured, 1}); }

  /// Features that the robot's laser sees through count as contradicted, but for those of `paired`; those
  /// contradicted often enough go. `is_free` tells whether a point of the robot's frame lies well within the
  /// free space seen. Returns the ids that went.
  std::vector<int> contradict(int robot, const FeatureScanOutcome& outcome,
                              const std::function<bool(const Eigen::Vector2d&)>& is_free);

  /// All that changes, for snapshots; options are of whoever restores it.
  auto changing() { return std::tie(state_, tentative_); }

 private:
  struct Tentative {
    Feature feature;  ///< in the map's frame, by the estimate then
    int robot = 0;
    int seen = 1;
    int age = 0;  ///< scans of that robot since

    auto members() { return std::tie(feature, robot, seen, age); }
  };

  std::vector<Candidate> choose(int robot, std::span<const ObservedFeature> seen,
                                std::vector<bool>& near_known);
  bool use(int robot, std::span<const Candidate> chosen, std::span<const ObservedFeature> seen);
  bool is_confirmed(int robot, const Feature& seen);
  void forget(int robot);

  FilterOptions options_;
  Gates gates_;
  Gates wide_gates_;
  FeatureState state_;
  std::vector<Tentative> tentative_;
};

}  // namespace isthmus
