#include "server/feature_maps/feature_estimator.hpp"

#include <algorithm>
#include <utility>
#include <variant>

#include "server/feature_maps/output/feature_record.hpp"

namespace isthmus {
namespace {

/// Places and zones are drawn on patches, and robots are found again among them.
bool is_about_patches(const Event& event) {
  return std::holds_alternative<AnnotationEvent>(event.body) ||
         std::holds_alternative<InitialPoseEvent>(event.body);
}

}  // namespace

FeatureEstimator::FeatureEstimator(const FeatureMapOptions& options) : options_(options), mapper_(options) {}

void FeatureEstimator::forbid(const std::set<std::int32_t>& fusions) {
  forbidden_ = fusions;
  mapper_.forbid(forbidden_);
}

Outcome FeatureEstimator::handle(const Event& event) {
  Outcome outcome;
  if (is_stranger(event)) {
    outcome.drop_reason = DropReason::unknown_robot;
    std::visit(
        [&](const auto& body) {
          if constexpr (requires { body.robot; }) count_dropped(body.robot, outcome.drop_reason, 1);
        },
        event.body);
    return outcome;
  }
  if (const auto* configuration = std::get_if<ConfigurationEvent>(&event.body))
    outcome.drop_reason = configure(*configuration);
  if (const auto* order = std::get_if<CommandEvent>(&event.body)) outcome.drop_reason = obey(*order);
  if (is_about_patches(event)) outcome.drop_reason = DropReason::no_manifold;
  ++events_;
  mapper_.handle(event);
  keep_inputs(outcome);
  if (outcome.drop_reason != DropReason::none) count_dropped("", outcome.drop_reason, 1);
  return outcome;
}

bool FeatureEstimator::is_stranger(const Event& event) const {
  const auto is_unknown = [&](const std::string& robot) { return !mapper_.knows(robot); };
  if (const auto* odometry = std::get_if<OdometryEvent>(&event.body)) return is_unknown(odometry->robot);
  if (const auto* scan = std::get_if<ScanEvent>(&event.body)) return is_unknown(scan->robot);
  if (const auto* sighting = std::get_if<SightingEvent>(&event.body)) return is_unknown(sighting->robot);
  return false;
}

void FeatureEstimator::count_dropped(const std::string& robot, DropReason reason, std::int64_t messages) {
  dropped_[reason] += messages;
  if (!robot.empty()) dropped_by_robot_[robot][reason] += messages;
}

bool FeatureEstimator::finish_step(Outcome& outcome) {
  mapper_.finish();
  keep_inputs(outcome);
  return false;
}

/// Only before every other event.
DropReason FeatureEstimator::configure(const ConfigurationEvent& event) {
  if (events_ > 0) return DropReason::late_configuration;
  auto parsed = parse_configuration(event.toml, "configuration");
  if (!std::holds_alternative<Configuration>(parsed)) return DropReason::bad_configuration;
  configuration_ = std::get<Configuration>(std::move(parsed));
  options_.any_tag = configuration_.any_tag;
  mapper_ = FeatureMapper(options_);
  mapper_.forbid(forbidden_);
  for (const auto& [name, robot] : configuration_.robots)
    if (robot.declared) mapper_.take(robot.robot);
  return DropReason::none;
}

DropReason FeatureEstimator::obey(const CommandEvent& order) {
  const auto id = static_cast<std::int32_t>(order.closure);
  if (order.verb == Verb::allow) return allow(order);
  if (order.verb == Verb::drop) {
    if (!mapper_.knows(order.robot)) return DropReason::unknown_robot;
    dropped_until_[order.robot] = inputs_.size();
    make_again();
    return DropReason::none;
  }
  if (order.verb == Verb::refine) return DropReason::no_manifold;  // a filter has nothing to refine
  if (!is_about_a_closure(order.verb)) return DropReason::none;
  const std::optional<FusionState> state = mapper_.state_of_fusion(id);
  if (order.closure < 0 || (!state && order.verb == Verb::withdraw)) return DropReason::no_such_closure;
  if (order.verb == Verb::withdraw && state != FusionState::accepted) return DropReason::not_accepted;
  forbidden_.insert(id);
  make_again();
  return DropReason::none;
}

DropReason FeatureEstimator::allow(const CommandEvent& order) {
  if (order.closure >= 0) {
    if (forbidden_.erase(static_cast<std::int32_t>(order.closure)) == 0) return DropReason::not_forbidden;
  } else if (dropped_until_.erase(order.robot) == 0) {
    return DropReason::not_dropped;
  }
  make_again();
  return DropReason::none;
}

void FeatureEstimator::keep_inputs(Outcome& outcome) {
  for (MapInput& input : mapper_.take_inputs()) inputs_.push_back(std::move(input));
  for (RobotPose& pose : mapper_.take_answers()) outcome.poses.push_back(std::move(pose));
  const std::optional<std::int32_t> contradicted = mapper_.contradicted_fusion();
  if (!contradicted) return;
  forbidden_.insert(*contradicted);
  ++withdrawn_;
  make_again();
}

/// Each time round one more fusion is forbidden, and there are only so many.
void FeatureEstimator::make_again() {
  for (;;) {
    FeatureMapper fresh(options_);
    fresh.forbid(forbidden_);
    std::optional<std::int32_t> contradicted;
    for (std::size_t i = 0; i < inputs_.size() && !contradicted; ++i) {
      if (is_left_out(i)) continue;
      fresh.apply(inputs_[i]);
      contradicted = fresh.contradicted_fusion();
    }
    fresh.take_answers();  // these scans are answered
    if (!contradicted) {
      fresh.continue_from(mapper_);
      mapper_ = std::move(fresh);
      return;
    }
    forbidden_.insert(*contradicted);
    ++withdrawn_;
  }
}

bool FeatureEstimator::is_left_out(std::size_t input) const {
  const MapInput& one = inputs_[input];
  if (one.kind == MapInputKind::declared || one.kind == MapInputKind::tag) return false;
  const auto until = dropped_until_.find(one.robot);
  return until != dropped_until_.end() && input < until->second;
}

FeatureMaps FeatureEstimator::maps() const {
  FeatureMaps maps = mapper_.maps();
  for (std::size_t team = 0; team < maps.teams.size(); ++team)
    smooth(maps.journeys, static_cast<int>(team), maps.teams[team].filter.state());
  maps.counts.withdrawn = withdrawn_;
  for (const auto& [reason, count] : dropped_) maps.counts.dropped[std::string(word(reason))] += count;
  return maps;
}

MapCopy FeatureEstimator::copy() const {
  MapCopy copy = record_of(mapper_.summary(), mapper_.told());
  for (const std::string& robot : mapper_.robot_names()) copy.health.push_back({robot, {}, {}});
  copy.tags = mapper_.tag_records();
  for (const auto& [reason, count] : dropped_) copy.counters.dropped[reason] += count;
  copy.counters.dropped_by_robot = dropped_by_robot_;
  return copy;
}

}  // namespace isthmus
