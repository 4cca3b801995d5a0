#include "server/wire/live/rendezvous_publisher.hpp"

#include "server/wire/message/path_pose.hpp"

namespace isthmus {
namespace {

bool is_same(const MeetingPlace& a, const MeetingPlace& b) {
  return a.robot == b.robot && a.pose.patch == b.pose.patch &&
         a.pose.patch_from_object == b.pose.patch_from_object;
}

bool is_same(const MeetingRecord& a, const MeetingRecord& b) {
  return a.closure == b.closure && is_same(a.a, b.a) && is_same(a.b, b.b);
}

}  // namespace

rendezvous_t rendezvous_message(const MapCopy& map, const MeetingRecord& meeting, std::int64_t utime) {
  rendezvous_t message{};
  message.utime = utime;
  message.closure = meeting.closure.value;
  message.robot_a = meeting.a.robot;
  message.island_a = map.graph.island(meeting.a.pose.patch).value;
  message.patch_a = meeting.a.pose.patch.value;
  set_pose(message.patch_a_from_meeting, meeting.a.pose.patch_from_object);
  message.robot_b = meeting.b.robot;
  message.island_b = map.graph.island(meeting.b.pose.patch).value;
  message.patch_b = meeting.b.pose.patch.value;
  set_pose(message.patch_b_from_meeting, meeting.b.pose.patch_from_object);
  return message;
}

std::optional<rendezvous_t> RendezvousPublisher::due(const MapCopy& map, std::int64_t utime,
                                                     std::chrono::steady_clock::time_point now) {
  const bool changed =
      map.meeting.has_value() != sent_.has_value() || (map.meeting && !is_same(*map.meeting, *sent_));
  if (!changed && now - sent_at_ < interval) return std::nullopt;
  sent_ = map.meeting;
  sent_at_ = now;
  if (!sent_) return std::nullopt;
  return rendezvous_message(map, *sent_, utime);
}

}  // namespace isthmus
