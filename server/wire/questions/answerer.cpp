#include "server/wire/questions/answerer.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "server/engine/annotations/annotations.hpp"
#include "server/paths/questions/frontiers.hpp"
#include "server/paths/questions/relative_pose.hpp"
#include "server/paths/questions/told_path.hpp"
#include "server/wire/message/path_pose.hpp"

namespace isthmus {
namespace {

Pose pose_of(const double (&components)[3]) { return {components[0], components[1], components[2]}; }

const Pose& pose_of_patch(const MapCopy& map, PatchId patch) {
  return map.poses[static_cast<std::size_t>(patch.value)];
}

bool is_on_map(const MapCopy& map, PatchId patch) { return check(map, {patch, {}}) == Refusal::none; }

Footprint footprint_of(const request_t& request) { return {request.radius_m, request.clearance_m}; }

void settle(reply_t& reply, Refusal refusal) {
  reply.done = refusal == Refusal::none ? 1 : 0;
  if (!reply.done) reply.reason = word(refusal);
}

ToldPath told_path(const reply_t& reply) {
  ToldPath told;
  for (const path_pose_t& pose : reply.poses) {
    told.poses.push_back({PatchId{pose.patch}, pose_of(pose.patch_from_robot)});
    told.map_points.emplace_back(pose.map_from_robot[0], pose.map_from_robot[1]);
  }
  return told;
}

/// What somebody asks from or about, or why it is nowhere.
struct Place {
  PlacedObject object;
  std::int64_t utime = 0;  ///< of a robot's scan; 0: it is none
  Refusal refusal = Refusal::none;
};

Place nowhere(Refusal refusal) { return {{}, 0, refusal}; }

Place at(const MapCopy& map, PatchId patch, const Pose& patch_from_object) {
  const ManifoldPose pose{patch, patch_from_object};
  return {{pose, Eigen::Matrix3d::Zero()}, 0, check(map, pose)};
}

/// A robot's pose when it took a patch.
Place patch(const MapCopy& map, PatchId id) {
  Place place = at(map, id, {});
  if (place.refusal == Refusal::none) place.object.robot = map.patches[index(id)]->robot;
  return place;
}

/// The robot's first patch on an island.
std::optional<PatchId> first_patch(const MapCopy& map, const std::string& robot, IslandId island) {
  for (const Session& session : map.sessions)
    if (session.robot == robot && is_on_map(map, session.first_patch) &&
        map.graph.island(session.first_patch) == island)
      return session.first_patch;
  return std::nullopt;
}

}  // namespace

/// The places of robots while one question is answered.
struct Answerer::Asked {
  const MapCopy& map;
  const RobotPoses& robots;
  const RobotPoses& robots_before;

  Place robot(const std::string& name) const {
    for (const RobotPoses* poses : {&robots, &robots_before}) {
      const auto found = poses->find(name);
      if (found == poses->end() || !is_on_map(map, found->second.pose.patch)) continue;
      return {{found->second.pose, found->second.covariance, name}, found->second.utime, Refusal::none};
    }
    return nowhere(Refusal::unknown_robot);
  }

  Place start(const request_t& request) const {
    if (!request.robot.empty()) return robot(request.robot);
    return at(map, PatchId{request.start_patch}, pose_of(request.patch_from_start));
  }

  Place target(const Question& question, const Place& start) const {
    const request_t& request = question.request;
    switch (question.target) {
      case Target::pose:
        return at(map, PatchId{request.target_patch}, pose_of(request.patch_from_target));
      case Target::patch:
        return patch(map, PatchId{request.target_patch});
      case Target::tag:
        return tag(request.target_barcode);
      case Target::place:
        return place(request.target_place);
      case Target::robot:
        return robot(request.target_robot);
      case Target::home:
        break;
    }
    const auto home = first_patch(map, request.robot, map.graph.island(start.object.pose.patch));
    return home ? patch(map, *home) : nowhere(Refusal::unknown_robot);
  }

  Place place(const std::string& name) const {
    const auto found = std::ranges::find_if(map.annotations, [&](const AnnotationRecord& one) {
      return one.kind == AnnotationKind::place && !one.lost && is_same_name(one.name, name);
    });
    if (found == map.annotations.end()) return nowhere(Refusal::unknown_place);
    return at(map, found->points.front().patch, found->points.front().patch_from_object);
  }

  Place tag(std::int32_t barcode) const {
    const auto found = std::find_if(map.tags.begin(), map.tags.end(), [barcode](const TagRecord& tag) {
      return tag.placed && tag.barcode == barcode;
    });
    return found == map.tags.end() ? nowhere(Refusal::unknown_tag) : at(map, found->patch, {});
  }
};

void Answerer::update(std::shared_ptr<const MapCopy> map, std::int64_t utime) {
  versions_.note(*map, utime);
  ways_.update(*map);
  planner_.update(std::move(map));
}

reply_t Answerer::answer(const Question& question, const RobotPoses& robots,
                         const RobotPoses& robots_before) {
  reply_t reply = empty_reply(question);
  settle(reply, fill(question, {planner_.map(), robots, robots_before}, reply));
  return reply;
}

reply_t Answerer::empty_reply(const Question& question) const {
  reply_t reply = reply_to(question.request);
  reply.map_version = versions_.version();
  reply.patches = static_cast<std::int32_t>(planner_.map().patches.size());
  return reply;
}

Refusal Answerer::fill(const Question& question, const Asked& asked, reply_t& reply) {
  switch (question.kind) {
    case QuestionKind::path:
    case QuestionKind::retro_traverse:
      return add_poses(find_path(question, asked, reply), reply);
    case QuestionKind::relative_pose:
      return fill_relative_pose(question, asked, reply);
    case QuestionKind::frontiers:
      return fill_frontiers(question, asked, reply);
    case QuestionKind::changes:
      return fill_changes(question, reply);
    case QuestionKind::map_version:
      break;
  }
  return Refusal::none;
}

Path Answerer::find_path(const Question& question, const Asked& asked, reply_t& reply) {
  const request_t& request = question.request;
  if (question.kind == QuestionKind::retro_traverse)
    return ways_.back(planner_.map(), planner_.near(), planner_.zones(), request.robot, request.since,
                      std::max(0.0, request.radius_m));
  const Place start = asked.start(request);
  if (start.refusal != Refusal::none) return {start.refusal, {}, 0, {}};
  const Place target = asked.target(question, start);
  if (target.refusal != Refusal::none) return {target.refusal, {}, 0, {}};
  PathQuestion path;
  path.from = start.object.pose;
  path.to = target.object.pose;
  path.footprint = footprint_of(request);
  reply.target_utime = target.utime;
  return planner_.path(path);
}

std::optional<reply_t> Answerer::update_of(const Question& question, const reply_t& told,
                                           const RobotPoses& robots, const RobotPoses& robots_before) {
  const Asked asked{planner_.map(), robots, robots_before};
  reply_t reply = empty_reply(question);
  PathNow now;
  now.path = find_path(question, asked, reply);
  const Refusal refusal = add_poses(now.path, reply);
  if (refusal != Refusal::none) now.path = {refusal, {}, 0, {}};
  const Place start = asked.start(question.request);
  if (start.refusal == Refusal::none)
    now.robot = start.object.pose;
  else if (refusal == Refusal::none)
    now.robot = now.path.poses.front();
  now.footprint = footprint_of(question.request);
  now.over_ground = question.kind == QuestionKind::path;
  now.drives = !question.request.robot.empty();
  const PathChange change = change_of(planner_, told_path(told), now);
  if (change == PathChange::none) return std::nullopt;
  reply.change = word(change);
  settle(reply, refusal);
  return reply;
}

Refusal Answerer::fill_relative_pose(const Question& question, const Asked& asked, reply_t& reply) const {
  const Place start = asked.start(question.request);
  if (start.refusal != Refusal::none) return start.refusal;
  const Place target = asked.target(question, start);
  if (target.refusal != Refusal::none) return target.refusal;
  const RelativePoseAnswer found = relative_pose(asked.map, start.object, target.object);
  if (found.refusal != Refusal::none) return found.refusal;
  reply.island = asked.map.graph.island(start.object.pose.patch).value;
  reply.target_utime = target.utime;
  set_pose(reply.start_from_target, found.a_from_b);
  for (int row = 0; row < 3; ++row)
    for (int column = 0; column < 3; ++column) reply.covariance[row][column] = found.covariance(row, column);
  for (const RelationId relation : found.chain) reply.chain.push_back(relation.value);
  reply.nchain = static_cast<std::int32_t>(reply.chain.size());
  return Refusal::none;
}

Refusal Answerer::fill_frontiers(const Question& question, const Asked& asked, reply_t& reply) {
  const Place start = asked.start(question.request);
  if (start.refusal != Refusal::none) return start.refusal;
  const Footprint footprint = footprint_of(question.request);
  if (check(footprint) != Refusal::none) return Refusal::bad_value;
  const IslandId island = asked.map.graph.island(start.object.pose.patch);
  const auto roadmap = planner_.roadmap(island, footprint);
  if (!roadmap) return Refusal::no_ground;
  const NodeId from = planner_.room_near(*roadmap, start.object.pose, PathQuestion{}.start_tolerance_m);
  if (from < 0) return Refusal::no_room;
  reply.island = island.value;
  const Ground& ground = roadmap->ground();
  for (const Frontier& frontier : find_frontiers(*roadmap, from)) {
    if (frontier.viewpoint < 0 || reply.frontiers.size() == max_frontiers) continue;
    const Eigen::Vector2d point = ground.centre(frontier.viewpoint), by = frontier.middle - point;
    const PatchId leader = ground.layer(frontier.viewpoint).leader;
    frontier_t message{};
    message.viewpoint =
        path_pose(asked.map, {leader, ominus({point.x(), point.y(), std::atan2(by.y(), by.x())},
                                             pose_of_patch(asked.map, leader))});
    message.map_from_middle[0] = frontier.middle.x();
    message.map_from_middle[1] = frontier.middle.y();
    message.size_m = frontier.size_m;
    message.gain_m2 = frontier.gain_m2;
    message.cost_m = frontier.cost_m;
    reply.frontiers.push_back(message);
  }
  reply.nfrontiers = static_cast<std::int32_t>(reply.frontiers.size());
  return Refusal::none;
}

Refusal Answerer::fill_changes(const Question& question, reply_t& reply) const {
  const auto changed = versions_.changed_since(question.request.since);
  if (!changed) return Refusal::bad_value;
  for (const PatchId patch : *changed) reply.changed.push_back(patch.value);
  reply.nchanged = static_cast<std::int32_t>(reply.changed.size());
  return Refusal::none;
}

Refusal Answerer::add_poses(const Path& path, reply_t& reply) const {
  if (path.refusal != Refusal::none) return path.refusal;
  if (path.poses.size() > max_poses) return Refusal::too_long;
  const MapCopy& map = planner_.map();
  reply.island = map.graph.island(path.poses.front().patch).value;
  reply.length_m = path.length_m;
  for (std::size_t i = 0; i < path.poses.size(); ++i) {
    reply.poses.push_back(path_pose(map, path.poses[i]));
    reply.poses.back().max_speed = path.max_speeds_m_s[i];
  }
  reply.nposes = static_cast<std::int32_t>(reply.poses.size());
  return Refusal::none;
}

reply_t reply_to(const request_t& request) {
  reply_t reply{};
  reply.request_utime = request.utime;
  reply.request_id = request.id;
  reply.asker = request.asker;
  reply.kind = request.kind;
  reply.island = -1;
  return reply;
}

}  // namespace isthmus
