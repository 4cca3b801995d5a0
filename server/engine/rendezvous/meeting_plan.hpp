#pragma once

#include <map>
#include <optional>
#include <string>
#include <tuple>

#include "server/engine/hypotheses/undecided.hpp"
#include "server/engine/input/options/rendezvous_options.hpp"
#include "server/engine/map/map.hpp"
#include "server/engine/rendezvous/meeting_record.hpp"
#include "server/engine/robot/robot.hpp"

namespace isthmus {

/// Two poses, each on its robot's own island, at which the two would see one another if a hypothesis is true,
/// and would not if it is false.
struct MeetingPlan {
  UndecidedHypothesis hypothesis;
  MeetingPlace a;  ///< on the island of the hypothesis' first patch
  MeetingPlace b;  ///< and of its second

  auto members() { return std::tie(hypothesis, a, b); }
};

/// Plans a meeting for a hypothesis between the islands of two robots. Each place is free in its own robot's
/// island; both islands hold the way from one to the other for free, as far as they know it. Nothing where
/// the patches are on one island, where no two robots that could see one another are there now, or where no
/// two such places are near.
std::optional<MeetingPlan> plan_meeting(const Map& map, const std::map<std::string, Robot>& robots,
                                        const UndecidedHypothesis& hypothesis, const MeetingOptions& options);

/// Whether at least one of two robots could read the other's barcode, as far as they have declared: those of
/// a team that wears barcodes are taken to read them.
bool could_see_one_another(const Robot& a, const Robot& b);

/// The plane of a hypothesis' first island from that of its second, were it true.
Pose first_map_from_second_map(const Map& map, const UndecidedHypothesis& hypothesis);

}  // namespace isthmus
