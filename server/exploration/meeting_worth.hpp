#pragma once

#include "server/engine/rendezvous/meeting_record.hpp"
#include "server/exploration/explore.hpp"

namespace isthmus {

/// What it takes two robots to settle by a meeting whether their islands are one building, and what that is
/// worth, in metres that robots drive.
struct MeetingWorth {
  double saved_m = 0;  ///< expected: of driving over what only the other island knows
  double cost_m = 0;   ///< there and back of those that have new ground to go to; no_way where one cannot
};

/// While two islands are not known to be one, the robots of each have what the other knows still to explore;
/// that is what a meeting saves, where the hypothesis is true. An undecided one is taken to be as likely true
/// as false. `has_work`: whether a robot has new ground to go to.
MeetingWorth worth_of_meeting(Planner& planner, const MeetingRecord& meeting, const Explorer& a,
                              bool a_has_work, const Explorer& b, bool b_has_work,
                              const ExplorationOptions& options);

}  // namespace isthmus
