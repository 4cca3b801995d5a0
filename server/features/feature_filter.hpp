#pragma once

#include <functional>
#include <optional>
#include <set>
#include <tuple>

#include "server/features/association/association.hpp"
#include "server/features/state/aside.hpp"
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
/// Deterministic. A step costs the square of the number of features at hand, and in a large map, once a few
/// metres, that times the square of all; beyond `max_features` known ones are corrected and none is added.
class FeatureFilter {
 public:
  explicit FeatureFilter(const FilterOptions& options = {});

  /// All robots, with the features at hand: points, which are told by what they are and not by where, and
  /// what robots see or may see soon. All features after `gather`, and in a map of twice `at_hand` or less.
  const FeatureState& state() const { return state_; }
  /// What waits is corrected: all is at hand until the next scan.
  void gather();
  /// All features, at hand or not.
  std::size_t feature_count() const;
  /// Another state instead, as a fusion makes one.
  void replace(FeatureState whole);
  const FilterOptions& options() const { return options_; }

  int add_robot(const Pose& map_from_robot, const Eigen::Matrix3d& covariance);
  /// Where a robot stands: what is measured there can be used later. Returns its id.
  int add_mark(int robot) { return isthmus::add_mark(state_, robot); }
  void remove_mark(int id) { isthmus::remove_mark(state_, id); }
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
  auto changing() { return std::tie(state_, aside_, used_, tentative_); }
  bool holds_together() const {
    return aside_ ? isthmus::is_sound(*aside_, state_) : state_.told.size() == 0;
  }

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
  void set_aside_what_is_far(int robot, std::span<const ObservedFeature> seen);
  bool has_grown() const;
  bool may_see_aside(int robot, std::span<const ObservedFeature> seen) const;

  FilterOptions options_;
  Gates gates_;
  Gates wide_gates_;
  FeatureState state_;
  std::optional<FeaturesAside> aside_;
  std::set<int> used_;  ///< features that were seen since any were set aside
  std::vector<Tentative> tentative_;
};

}  // namespace isthmus
