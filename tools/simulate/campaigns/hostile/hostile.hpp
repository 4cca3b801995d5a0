#pragma once

#include <cstdint>
#include <map>
#include <string>

#include "server/engine/input/drop_reason.hpp"
#include "tools/simulate/campaigns/sightings/sightings.hpp"
#include "tools/simulate/run/simulation.hpp"

namespace isthmus {

/// In whose name the well-formed ones are.
enum class HostileNames {
  intruder,  ///< of a robot that joins the team: nobody else's map is to suffer
  everyone   ///< of every robot: their map is at the mercy of it; the server is to live
};

/// A team's run through a server that hears hostile messages between the team's: the team's own with bits and
/// bytes changed, cut, lengthened, spliced or of random bytes, in the name of a robot that joins the team, of
/// strangers, and of the server itself; a tenth are well formed and make no sense (unruly_event).
struct HostileTrial {
  std::int64_t messages = 0;                   ///< hostile ones that were sent
  std::map<DropReason, std::int64_t> dropped;  ///< messages, and why
  std::size_t hostile_patches =
      0;                      ///< that the map holds of it: what was well formed is mapped as it is told
  RelationComparison errors;  ///< of the team, against its run without them
  double cpu_s = 0;
  double peak_rss_mb = 0;
};

/// Throws std::runtime_error where the server did not take a message of the team's.
HostileTrial try_hostile_messages(const Scenario& scenario, std::uint64_t seed, std::int64_t messages,
                                  HostileNames names = HostileNames::intruder);

}  // namespace isthmus
