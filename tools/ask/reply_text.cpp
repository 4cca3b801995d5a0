#include "tools/ask/reply_text.hpp"

#include <cstdio>

#include "server/wire/message/reason_sentence.hpp"

namespace isthmus {
namespace {

std::string number(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%.6g", value);
  return text;
}

std::string row(const path_pose_t& pose) {
  std::string text = std::to_string(pose.patch);
  for (const double value : pose.patch_from_robot) text += "," + number(value);
  for (const double value : pose.map_from_robot) text += "," + number(value);
  return text;
}

constexpr const char* pose_header = "patch,patch_x_m,patch_y_m,patch_yaw_rad,map_x_m,map_y_m,map_yaw_rad";

std::string poses(const reply_t& reply) {
  std::string text = std::string(pose_header) + ",max_speed_m_s\n";
  for (const path_pose_t& pose : reply.poses) text += row(pose) + "," + number(pose.max_speed) + "\n";
  return text;
}

std::string frontiers(const reply_t& reply) {
  std::string text = std::string(pose_header) + ",size_m,gain_m2,cost_m\n";
  for (const frontier_t& frontier : reply.frontiers)
    text += row(frontier.viewpoint) + "," + number(frontier.size_m) + "," + number(frontier.gain_m2) + "," +
            number(frontier.cost_m) + "\n";
  return text;
}

std::string relative_pose(const reply_t& reply) {
  std::string text = "x_m,y_m,yaw_rad,xx,xy,xyaw,yy,yyaw,yawyaw,relations\n";
  for (const double value : reply.start_from_target) text += number(value) + ",";
  for (int row = 0; row < 3; ++row)
    for (int column = row; column < 3; ++column) text += number(reply.covariance[row][column]) + ",";
  for (std::size_t i = 0; i < reply.chain.size(); ++i)
    text += (i > 0 ? " " : "") + std::to_string(reply.chain[i]);
  return text + "\n";
}

std::string changes(const reply_t& reply) {
  std::string text = "patch\n";
  for (const std::int32_t patch : reply.changed) text += std::to_string(patch) + "\n";
  return text;
}

}  // namespace

std::string to_text(const reply_t& reply) {
  if (reply.kind == "relative_pose") return relative_pose(reply);
  if (reply.kind == "frontiers") return frontiers(reply);
  if (reply.kind == "changes") return changes(reply);
  if (reply.kind == "map_version")
    return "map_version,patches\n" + std::to_string(reply.map_version) + "," + std::to_string(reply.patches) +
           "\n";
  return poses(reply);
}

std::string update_text(const reply_t& reply) {
  const std::string head = "# " + (reply.change.empty() ? "path" : reply.change);
  return reply.done
             ? head + ", " + number(reply.length_m) + " m\n" + to_text(reply)
             : head + ", none: " + with_sentence(reply.reason, sentence_of_question(reply.reason)) + "\n";
}

}  // namespace isthmus
