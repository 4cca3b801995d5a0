#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "patches/pose.hpp"
#include "server/engine/input/options/sighting_options.hpp"

namespace isthmus {

/// A sighting between the planes of two islands: one holds the observer, the other
/// what it saw. A sigma of +infinity: that part was not measured.
struct ProjectedSighting {
  bool observer_in_first = true;
  std::int64_t utime = 0;
  Pose plane_from_observer;                                       ///< in the observer's own plane
  Eigen::Matrix3d observer_covariance = Eigen::Matrix3d::Zero();  ///< of that, in the observer's own axes
  Eigen::Vector2d target = Eigen::Vector2d::Zero();               ///< in the other plane
  double target_variance = 0;                                     ///< per axis
  double range_m = 0;
  double range_sigma_m = 0;
  double bearing_rad = 0;
  double bearing_sigma_rad = 0;

  bool has_range() const;
  bool has_bearing() const;
};

/// How one plane lies in another, as several sightings say together.
struct Alignment {
  Pose first_from_second;
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
  std::vector<std::size_t> supporters;  ///< indices of the sightings that agree
  bool two_way = false;                 ///< there are some of either direction among them
  double baseline_m = 0;                ///< between the farthest two of the points that they tie together
};

/// Squared distance in sigmas of what was measured from what the alignment predicts (one degree of freedom
/// for range, one for bearing). The sigmas are those of the measurement, of both poses, and of what clocks
/// and odometry leave open.
double chi_squared(const ProjectedSighting& sighting, const Pose& first_from_second,
                   const AlignmentOptions& options);

/// Whether a sighting agrees with an alignment: chi² within 99.9 %.
bool agrees(const ProjectedSighting& sighting, const Pose& first_from_second,
            const AlignmentOptions& options);

/// The relative pose that most sightings agree on (Zhou and Roumeliotis 2006, eqs. 1-12, for any number of
/// sightings of either direction). A sighting with range and bearing ties a point of one plane to a point of
/// the other; two of them, apart from each other, give the relative pose in closed form: a mutual pair is the
/// case of two robots' positions, whose distance both have measured. The best of all such pairs is refined by
/// all that agree with it. Nothing where no two agree.
std::optional<Alignment> best_alignment(std::span<const ProjectedSighting> sightings,
                                        const AlignmentOptions& options);

/// The least-squares relative pose of the sightings given, from a start.
Alignment fit_alignment(std::span<const ProjectedSighting> sightings, std::vector<std::size_t> supporters,
                        const Pose& start, const AlignmentOptions& options);

/// Whether an alignment of some of these sightings is worth a trial: its supporters are enough, and more than
/// those that disagree at about the same time. A lone pair of either direction waits a while for a third;
/// sightings of one direction alone must be as many and tie points that lie apart.
bool ready(const Alignment& alignment, std::span<const ProjectedSighting> sightings, std::int64_t now_utime,
           bool no_more_waiting, const AlignmentOptions& options);

}  // namespace isthmus
