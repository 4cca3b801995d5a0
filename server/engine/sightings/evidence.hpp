#pragma once

#include <cstddef>
#include <map>
#include <optional>
#include <string>
#include <tuple>
#include <vector>

#include "server/engine/input/event.hpp"
#include "server/engine/map/map.hpp"
#include "server/engine/map/reason.hpp"
#include "server/engine/robot/robot.hpp"
#include "server/engine/sightings/alignment.hpp"

namespace isthmus {

/// The name of a fixed tag where robots have theirs.
std::string tag_name(std::int32_t barcode);

/// A fixed tag on the map: a patch without extent, whose yaw means nothing.
PatchPtr make_tag_patch(PatchId id, std::int32_t barcode, std::int64_t utime);

/// A sighting with the places on the manifold that it ties together.
struct Evidence {
  std::size_t record = 0;  ///< its place among all sightings
  std::int64_t receive_utime = 0;
  SightingEvent sighting;
  PastPlace observer;
  std::string target;  ///< a robot's name, or "TAG n"
  bool is_tag = false;
  /// Of a tag: where its patch is, once it has one.
  std::optional<PastPlace> target_place;
  Reason doubt = Reason::unsupported;  ///< why it would be refused if nothing more came
  bool judge_again = false;            ///< the map has changed since it was judged

  auto members() {
    return std::tie(record, receive_utime, sighting, observer, target, is_tag, target_place, doubt,
                    judge_again);
  }
};

/// The sighting between the planes of its two ends as the map projects them now. `observer_in_first` is left
/// to the caller.
ProjectedSighting project_sighting(const Map& map, const Evidence& evidence);

/// The same between a plane and a point in it: where the map has the tag, or would have it.
ProjectedSighting project_sighting_of_point(const Map& map, const Evidence& evidence,
                                            const Eigen::Vector2d& target, double target_variance);

/// Where in the observer's plane the sighting puts its target; nothing where range or bearing is missing.
std::optional<Eigen::Vector2d> measured_point(const Map& map, const Evidence& evidence);

/// Sightings of one fixed thing from one island that agree on where in it the thing is.
struct PointConsensus {
  std::vector<std::size_t> supporters;
  Eigen::Vector2d point = Eigen::Vector2d::Zero();
  double apart_m = 0;  ///< between the places it was seen from
  bool enough(const EvidenceOptions& options) const;
};
/// Whether so many sightings of one point place it: many, or two from places so far apart.
bool places_a_point(std::size_t sightings, double apart_m, const EvidenceOptions& options);
/// The largest such group among the `members` of a pool.
PointConsensus agree_on_a_point(const Map& map, const std::vector<Evidence>& pool,
                                const std::vector<std::size_t>& members, const AlignmentOptions& options);

/// The sighting as a relation between two patches: range with bearing as a point of b at a point of a, its
/// covariance taken at the measured range and then fixed; range alone and bearing alone as themselves. The
/// covariances of both places in their patches are carried. Nothing where both ends are on one patch.
std::optional<Relation> sighting_relation(const Map& map, const Evidence& evidence, ClosureId closure,
                                          const AlignmentOptions& alignment, const EvidenceOptions& options);

}  // namespace isthmus
