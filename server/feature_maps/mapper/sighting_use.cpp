// What a FeatureMapper makes of a sighting, and how it tells of it.

#include <cmath>

#include "relations/chi_squared.hpp"
#include "server/feature_maps/mapper/feature_mapper.hpp"
#include "server/feature_maps/output/feature_record.hpp"
#include "server/features/state/measurement.hpp"

namespace isthmus {
namespace {

/// Of a σ: infinity is what was not measured.
bool is_right(double value, double sigma) { return std::isinf(sigma) || std::isfinite(value); }

/// Whether there is a range, a bearing or both, as sound numbers.
bool is_usable(const SightingEvent& s) {
  const bool range = std::isfinite(s.range_sigma_m), bearing = std::isfinite(s.bearing_sigma_rad);
  return s.range_sigma_m > 0 && s.bearing_sigma_rad > 0 && (range || bearing) &&
         is_right(s.range_m, s.range_sigma_m) && is_right(s.bearing_rad, s.bearing_sigma_rad) &&
         (!range || s.range_m > 0);
}

bool is_whole(const SightingEvent& s) {
  return std::isfinite(s.range_sigma_m) && std::isfinite(s.bearing_sigma_rad);
}

/// The landmark in the robot's frame.
ObservedFeature point_seen(const SightingEvent& s) {
  const Eigen::Vector2d ray(std::cos(s.bearing_rad), std::sin(s.bearing_rad)), side(-ray.y(), ray.x());
  const double across = s.range_m * s.bearing_sigma_rad;
  return {point_feature(s.range_m * ray), s.range_sigma_m * s.range_sigma_m * ray * ray.transpose() +
                                              across * across * side * side.transpose()};
}

}  // namespace

std::string FeatureMapper::use(FeatureRobot& robot, const MapInput& input) {
  const auto& sighting = std::get<SightingEvent>(input.event->body);
  if (!is_usable(sighting)) return "incomplete";
  std::int64_t& last = last_used_[{sighting.robot, sighting.barcode}];
  if (last != 0 && std::abs(seconds_between(last, sighting.utime)) < options_.repeat_s) return "repeated";
  last = sighting.utime;
  const auto wearer = wearers_.find(sighting.barcode);
  const bool is_tag = tags_.contains(sighting.barcode) || (options_.any_tag && wearer == wearers_.end());
  if (is_tag) return use_landmark(robot, input);
  if (wearer == wearers_.end() || wearer->second == sighting.robot) return "unknown_barcode";
  FeatureRobot& target = robots_.at(wearer->second);
  if (target.journey < 0) return "target_not_on_map";
  const std::int64_t known_utime = input.utime - static_cast<std::int64_t>(1e6 * input.target_late_s);
  if (input.odom_from_target && known_utime > target.last_utime) {
    note_way(target, *input.odom_from_target);
    target.last_utime = known_utime;
  }
  move_by_odometry(target);
  return use_robot(robot, input, target);
}

std::string FeatureMapper::use_landmark(FeatureRobot& robot, const MapInput& input) {
  const auto& sighting = std::get<SightingEvent>(input.event->body);
  Journey& own = journey(robot);
  Team& team = team_of(own);
  const auto known = team.landmarks.find(sighting.barcode);
  const int id = known == team.landmarks.end() ? -1 : known->second;
  const auto index = index_of(team.filter.state(), id);
  if (index) {
    const RelativeSighting seen{own.member,
                                0,
                                sighting.range_m,
                                sighting.bearing_rad,
                                sighting.range_sigma_m,
                                sighting.bearing_sigma_rad};
    const auto measured =  // as it will be used
        is_whole(sighting) ? measure_feature(team.filter.state(), *index, own.member, point_seen(sighting))
                           : measure_point(team.filter.state(), *index, seen);
    const double gate = chi2_quantile(options_.sighting_probability, is_whole(sighting) ? 2 : 1);
    if (!measured || squared_distance(team.filter.state().covariance, *measured) > gate)
      return "contradicts_map";
    if (!is_whole(sighting)) return team.filter.correct_by(*measured) ? "" : "not_used";
  }
  if (!is_whole(sighting)) return "place_not_known";
  const ObservedFeature seen = point_seen(sighting);
  const std::vector<int> used = team.filter.observe_known(own.member, {&seen, 1}, {&id, 1});
  if (used.front() < 0) return "not_used";
  team.landmarks[sighting.barcode] = used.front();
  stop(robot, input.utime, {{used.front(), false, seen}});
  first_seen_.try_emplace({robot.journey, sighting.barcode}, input.number);
  if (options_.kind == FeatureMapKind::points) {
    join_by_landmarks();
  } else {
    for (int other = 0; other < static_cast<int>(teams_.size()); ++other)
      if (other != own.team && teams_[static_cast<std::size_t>(other)].landmarks.contains(sighting.barcode))
        consider(std::min(own.team, other), std::max(own.team, other));
  }
  return "";
}

std::string FeatureMapper::use_robot(FeatureRobot& robot, const MapInput& input, FeatureRobot& target) {
  if (journey(robot).team == journey(target).team) return use_on_one_map(input, robot, target);
  if (options_.kind == FeatureMapKind::points) return "maps_share_no_landmarks";
  return hear(input, robot.journey, target.journey, target);
}

std::string FeatureMapper::use_on_one_map(const MapInput& input, FeatureRobot& robot, FeatureRobot& target) {
  const auto& sighting = std::get<SightingEvent>(input.event->body);
  const Journey &own = journey(robot), &other = journey(target);
  FeatureFilter& filter = team_of(own).filter;
  const RelativeSighting seen{own.member,           other.member,           sighting.range_m,
                              sighting.bearing_rad, sighting.range_sigma_m, sighting.bearing_sigma_rad};
  const auto measured = measure_robot(filter.state(), seen);
  if (!measured) return "not_used";
  judge_fusion(robot.journey, target.journey, *measured, sighting);
  const double gate =
      chi2_quantile(options_.sighting_probability, static_cast<int>(measured->residual.size()));
  if (squared_distance(filter.state().covariance, *measured) > gate) return "contradicts_map";
  if (!filter.observe_robot(seen)) return "not_used";
  stop(target, target.last_utime, {});
  stop(robot, input.utime, {}, {{target.journey, static_cast<int>(other.stops.size()) - 1, seen}});
  return "";
}

void FeatureMapper::tell(std::size_t sighting) {
  const SightingRecord record = record_of(sightings_[sighting]);
  if (sighting == told_.size())
    told_.append(record);
  else
    told_.set_verdict(sighting, record.verdict, record.reason, record.closure);
}

}  // namespace isthmus
