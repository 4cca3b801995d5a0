#include "server/wire/page/texts/asked.hpp"

#include <algorithm>
#include <nlohmann/json.hpp>

#include "server/wire/page/texts/drawn_points.hpp"

namespace isthmus {
namespace {

using Json = nlohmann::json;

}  // namespace

void Asked::add(const reply_t& reply) {
  if (!reply.done || (reply.poses.empty() && reply.frontiers.empty())) return;
  Answer answer{reply.kind, reply.utime, thinned(reply.poses), {}};
  for (const frontier_t& frontier : reply.frontiers) {
    answer.poses.push_back(manifold_pose(frontier.viewpoint));
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
