#pragma once

#include <span>
#include <vector>

#include "server/features/state/correction.hpp"

namespace isthmus {

/// That observation `seen` (its place in a scan) is feature `index` of the state, as a measurement.
struct Candidate {
  std::size_t seen = 0;
  std::size_t index = 0;
  LinearMeasurement measurement;
  double squared_distance = 0;  ///< of this pairing alone
  bool line_alone = false;      ///< a segment of which an end disagrees: only its line is used
};

/// χ² bounds of one probability, by degrees of freedom; made once.
class Gates {
 public:
  explicit Gates(double probability, int max_degrees_of_freedom = 256);
  /// Beyond the most, the bound of the most times what it is exceeded by.
  double operator()(Eigen::Index degrees_of_freedom) const;

 private:
  std::vector<double> bounds_;
};

/// Which features of the state each observation of a scan may be: of its kind, overlapping it (τ), and within
/// the gate (M_α, M_ρ and the ends as one, Benedettelli et al. 2012, 3.1). Where only the ends disagree, the
/// line alone counts: an end may be found wrongly. By observation, nearest first.
std::vector<Candidate> candidates(const FeatureState& state, int robot, std::span<const ObservedFeature> seen,
                                  const AssociationOptions& options, const Gates& gates);

/// Whether an observation of the scan may be a feature of the map by its kind and by overlapping it,
/// wherever.
bool is_like_any(const Feature& feature, const Pose& map_from_robot, std::span<const ObservedFeature> seen,
                 const AssociationOptions& options);

/// The share of the shorter segment along which two lie side by side, ends that were not seen reaching on by
/// `free_end_reach_m`; 1 for what has no length.
double overlap(const Feature& seen, const Feature& expected, double free_end_reach_m);

/// The largest set of candidates, each observation and each feature once, that is compatible as a whole; of
/// sets as large, the one with the least joint distance: joint compatibility by branch and bound (Neira and
/// Tardos 2001), the joint distance carried along by a growing Cholesky factor. Bounded by `max_steps`.
/// Indices into `all`, ascending.
std::vector<std::size_t> largest_compatible(const Eigen::MatrixXd& covariance, std::span<const Candidate> all,
                                            const AssociationOptions& options, const Gates& gates);

/// Each observation to its nearest candidate; a feature that several claim to the nearest of them.
std::vector<std::size_t> nearest_pairs(std::span<const Candidate> all);

}  // namespace isthmus
