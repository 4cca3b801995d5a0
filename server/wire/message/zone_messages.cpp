#include "server/wire/message/zone_messages.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "server/engine/input/robot_name.hpp"

namespace isthmus {
namespace {

zone_t zone_message(const AnnotationRecord& annotation, const MapCopy& map, std::int32_t id) {
  zone_t message{};
  message.id = id;
  message.kind = std::string(word(annotation.kind));
  message.name = annotation.name;
  message.island = annotation.island.value;
  message.max_speed = annotation.max_speed_m_s;
  for (const ManifoldPose& corner : annotation.points) {
    const Pose at = map.poses[static_cast<std::size_t>(corner.patch.value)] * corner.patch_from_object;
    message.x_m.push_back(at.x);
    message.y_m.push_back(at.y);
    if (!is_zone(annotation.kind)) message.yaw = at.yaw;
  }
  message.ncorners = static_cast<std::int32_t>(message.x_m.size());
  return message;
}

bool are_still_corners(const std::vector<double>& a, const std::vector<double>& b) {
  return std::ranges::equal(
      a, b, [](double one, double other) { return std::abs(one - other) < ZoneMessages::still_m; });
}

bool is_still_zone(const zone_t& a, const zone_t& b) {
  return a.id == b.id && a.kind == b.kind && a.name == b.name && a.island == b.island &&
         a.max_speed == b.max_speed && std::abs(wrap_angle(a.yaw - b.yaw)) < ZoneMessages::still_rad &&
         are_still_corners(a.x_m, b.x_m) && are_still_corners(a.y_m, b.y_m);
}

}  // namespace

zones_t ZoneMessages::whole(const MapCopy& map, std::int64_t utime) { return sent_ = message(map, utime); }

std::optional<zones_t> ZoneMessages::changes(const MapCopy& map, std::int64_t utime) {
  zones_t now = message(map, utime);
  if (std::ranges::equal(now.zones, sent_.zones, is_still_zone)) return std::nullopt;
  return sent_ = std::move(now);
}

zones_t ZoneMessages::message(const MapCopy& map, std::int64_t utime) {
  zones_t message{};
  message.utime = utime;
  std::map<std::string, std::int32_t> ids;
  for (const AnnotationRecord& annotation : map.annotations) {
    const std::string name = upper_case(annotation.name);
    const auto known = ids_.find(name);
    const std::int32_t id = ids[name] = known == ids_.end() ? next_id_++ : known->second;
    if (!annotation.lost) message.zones.push_back(zone_message(annotation, map, id));
  }
  ids_ = std::move(ids);
  message.nzones = static_cast<std::int32_t>(message.zones.size());
  return message;
}

}  // namespace isthmus
