#pragma once

#include <cstdint>
#include <string_view>
#include <variant>

#include "patches/ids.hpp"
#include "relations/quadratic_form.hpp"

namespace isthmus {

/// Where a relation came from. Relations of different origin are never summed into one another, so that a
/// closure can be taken back.
enum class OriginKind { odometry, match, sighting, propagation, hypothesis, start };

struct Origin {
  OriginKind kind = OriginKind::match;
  ClosureId closure;           ///< of propagation, sighting and hypothesis; none otherwise
  std::int32_t sighting = -1;  ///< of a sighting: its number among all sightings

  bool operator==(const Origin&) const = default;
};

/// What point correspondences say of b in a: points of b on points or lines of a. Points of a on lines of b
/// are the same with a and b exchanged: a relation of its own.
struct Correspondences {
  QuadraticForm form;
  int count = 0;  ///< correspondences in the form
  /// What the pair alone says: its pose of least cost of all. χ² of the pair is 2 (cost − least.cost), at
  /// most 3 degrees of freedom. RelationGraph sets it when the relation is stored.
  QuadraticForm::Minimum least;
};

/// The pose of b in a, with its information by (x, y, yaw): odometry, and measured starts.
struct RelativePose {
  Pose a_from_b;
  Eigen::Matrix3d information = Eigen::Matrix3d::Identity();
};

/// The distance between a point of a and a point of b (σ in metres).
struct Range {
  Eigen::Vector2d point_a = Eigen::Vector2d::Zero();
  Eigen::Vector2d point_b = Eigen::Vector2d::Zero();
  double range_m = 0;
  double sigma_m = 1;
};

/// The bearing of a point of b seen by an observer in a (radians from the observer's x axis).
struct Bearing {
  Pose a_from_observer;
  Eigen::Vector2d point_b = Eigen::Vector2d::Zero();
  double bearing_rad = 0;
  double sigma_rad = 1;
};

using Measurement = std::variant<Correspondences, RelativePose, Range, Bearing>;

/// What kind of feature a Correspondences relation was built from; for the record only.
enum class RelationKind {
  point_to_line,
  point_to_point,
  line_to_line,
  range_bearing,
  relative_pose,
  odometry,
  range,
  bearing
};

/// A relation between two patches (eq. 4): a measurement of b as seen from a, with its noise and origin.
struct Relation {
  RelationId id;
  PatchId a;
  PatchId b;
  RelationKind kind = RelationKind::point_to_line;
  Measurement measurement;
  Origin origin;
  /// Scale s of the robust loss on the block's cost c = |e|²: Cauchy, ρ(c) = s² log(1 + c / s²), judging the
  /// pair as a whole. For Correspondences c = |R v|² − 2 least.cost: what the pair costs above its own
  /// minimum. 0: none.
  double robust_scale = 0;
};

std::string_view name(OriginKind kind);
std::string_view name(RelationKind kind);

/// Number of correspondences (1 for kinds that are one measurement).
int count(const Relation& relation);

/// ½|e|², before any robust loss, at the pose of b in a.
double cost(const Measurement& measurement, const Pose& a_from_b);

/// ½ρ(c), the robust loss applied; ½|e|² where there is none.
double cost(const Relation& relation, const Pose& a_from_b);

/// c, what the robust loss judges: twice the cost above the least the measurement can cost.
double chi_squared(const Measurement& measurement, const Pose& a_from_b);

/// ρ'(c), the share of its information that a relation keeps under its robust loss.
double robust_weight(double chi_squared, double robust_scale);

/// Gauss-Newton information by the (x, y, yaw) of a_from_b, robust loss not applied.
Eigen::Matrix3d information(const Measurement& measurement, const Pose& a_from_b);

/// The same weighted by the robust loss at that pose.
Eigen::Matrix3d information(const Relation& relation, const Pose& a_from_b);

/// The pose of least cost nearest to `start`, where the measurement determines one.
Pose minimiser(const Measurement& measurement, const Pose& start);

}  // namespace isthmus
