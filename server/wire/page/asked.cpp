#include "server/wire/page/asked.hpp"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

namespace isthmus {
namespace {

using Json = nlohmann::json;

ManifoldPose pose_of(const path_pose_t& pose) {
  const auto& [x, y, yaw] = pose.patch_from_robot;
  return {PatchId{pose.patch}, {x, y, yaw}};
}

/// To the centimetre.
double to_centimetres(double value) { return std::isfinite(value) ? std::round(value * 1e2) / 1e2 : 0; }

}  // namespace

void Asked::add(const reply_t& reply) {
  if (!reply.done || (reply.poses.empty() && reply.frontiers.empty())) return;
  Answer answer{reply.kind, reply.utime, {}, {}};
  const std::size_t step = 1 + reply.poses.size() / max_poses;
  for (std::size_t i = 0; i < reply.poses.size(); i += step) answer.poses.push_back(pose_of(reply.poses[i]));
  if (!reply.poses.empty() && (reply.poses.size() - 1) % step != 0)
    answer.poses.push_back(pose_of(reply.poses.back()));
  for (const frontier_t& frontier : reply.frontiers) {
    answer.poses.push_back(pose_of(frontier.viewpoint));
    answer.gains_m2.push_back(frontier.gain_m2);
  }
  answers_[reply.asker + " " + (reply.frontiers.empty() ? "path" : "frontiers")] = std::move(answer);
  if (answers_.size() <= max_askers) return;
  answers_.erase(std::ranges::min_element(answers_, {}, [](const auto& one) { return one.second.utime; }));
}

std::string Asked::text(const ShownMap& shown, std::int64_t now_utime) {
  std::erase_if(answers_, [&](const auto& one) { return now_utime > one.second.utime + shown_us; });
  Json all = Json::array();
  for (const auto& [key, answer] : answers_) {
    Json points = Json::array();
    IslandId island;
    for (std::size_t i = 0; i < answer.poses.size(); ++i) {
      const ManifoldPose& pose = answer.poses[i];
      if (!shown.has(pose.patch)) continue;
      if (!island.valid()) island = shown.island(pose.patch);
      if (shown.island(pose.patch) != island) continue;
      const Pose at = shown.project(pose);
      points.push_back(Json::array({to_centimetres(at.x), to_centimetres(at.y)}));
      if (i < answer.gains_m2.size()) points.back().push_back(to_centimetres(answer.gains_m2[i]));
    }
    all.push_back({{"asker", key.substr(0, key.rfind(' '))},
                   {"kind", answer.kind},
                   {"island", island.value},
                   {"points", std::move(points)}});
  }
  return all.dump(-1, ' ', false, Json::error_handler_t::replace);
}

}  // namespace isthmus
