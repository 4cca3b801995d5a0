// What a FeatureMapper makes of meetings of robots whose maps had nothing in common then.

#include "server/feature_maps/mapper/feature_mapper.hpp"

namespace isthmus {
namespace {

OpenMeeting reversed(const OpenMeeting& meeting) {
  const RobotAlignment& forth = meeting.alignment;
  const Eigen::Matrix3d by = inverse_jacobian(forth.one_from_two);
  RobotAlignment back = forth;
  back.one_from_two = inverse(forth.one_from_two);
  back.covariance = by * forth.covariance * by.transpose();
  return {meeting.mark_2, meeting.mark_1, back, meeting.fusion, meeting.views};
}

}  // namespace

void FeatureMapper::keep_open(int one, int two, int member_1, int member_2, const RobotAlignment& alignment,
                              std::int32_t fusion) {
  close_meeting(one, two);
  Team &first = teams_[static_cast<std::size_t>(one)], &second = teams_[static_cast<std::size_t>(two)];
  open_[{one, two}] = {first.filter.add_mark(member_1), second.filter.add_mark(member_2), alignment, fusion,
                       views_of(one) + views_of(two)};
}

void FeatureMapper::close_meeting(int one, int two) {
  const auto found = open_.find({one, two});
  if (found == open_.end()) return;
  teams_[static_cast<std::size_t>(one)].filter.remove_mark(found->second.mark_1);
  teams_[static_cast<std::size_t>(two)].filter.remove_mark(found->second.mark_2);
  open_.erase(found);
}

/// The second of two maps has become part of the first: so have its meetings with others.
void FeatureMapper::hand_over_meetings(int one, int two, int ids) {
  FeatureFilter& kept = teams_[static_cast<std::size_t>(one)].filter;
  if (const auto own = open_.extract({one, two})) {
    kept.remove_mark(own.mapped().mark_1);
    kept.remove_mark(own.mapped().mark_2 + ids);
  }
  std::map<std::pair<int, int>, OpenMeeting> of_two;
  std::erase_if(open_, [&](const auto& entry) {
    const bool is_moved = entry.first.first == two || entry.first.second == two;
    if (is_moved) of_two.insert(entry);
    return is_moved;
  });
  for (auto& [maps, meeting] : of_two) {
    const bool was_first = maps.first == two;
    const int other = was_first ? maps.second : maps.first;
    (was_first ? meeting.mark_1 : meeting.mark_2) += ids;
    if ((one < other) != was_first) meeting = reversed(meeting);
    const std::pair<int, int> now = std::minmax(one, other);
    if (open_.contains(now)) close_meeting(now.first, now.second);
    open_[now] = meeting;
  }
}

/// Looks for what a map that has grown has in common with those whose robots its own met.
void FeatureMapper::take_up_meetings(int grown) {
  for (auto& [maps, meeting] : open_) {
    const auto [one, two] = maps;
    if (one != grown && two != grown) continue;
    Team &first = teams_[static_cast<std::size_t>(one)], &second = teams_[static_cast<std::size_t>(two)];
    const std::size_t views = views_of(one) + views_of(two);
    if (!have_grown(meeting.views, views)) continue;
    meeting.views = views;
    first.filter.gather();
    second.filter.gather();
    const JoinedTeams joined = joined_at_meeting(first, {meeting.mark_1, true}, second,
                                                 {meeting.mark_2, true}, meeting.alignment, options_.fusion);
    if (joined.duplicates.empty()) continue;
    FusionRecord& record = fusions_.at(meeting.fusion);
    std::set<std::size_t> agreeing;
    for (const Heard& heard : heard_between(one, two))
      if (heard.fusion == record.id) agreeing.insert(heard.row);
    accept(one, two, joined, agreeing, record);
    return;  // others when it grows again
  }
}

}  // namespace isthmus
