#pragma once

#include <map>
#include <set>
#include <string>
#include <vector>

#include "server/engine/input/engine_options.hpp"
#include "server/engine/robot/robot.hpp"

namespace isthmus {

/// What a withdrawal took out of the map.
struct Withdrawal {
  std::vector<Relation> gone;  ///< by id
  std::set<ClosureId> fallen;  ///< other closures that rested on it: their relations are gone too
};

/// Takes an accepted closure back. Its own relations go, and every relation that depends on it
/// (dependencies.hpp) is judged again by what is left, in the order in which they were made: it stays where
/// its ends are known to be near without it, or where they are on one island still, well determined relative
/// to one another, and it agrees with how the refitted map has them. A closure of which a sighting or find
/// does not stay has fallen with it, and takes its own part with it likewise. The rest is refitted, islands
/// part where nothing else joins them, and robots that stood on the other side are put back on their own.
Withdrawal withdraw(Map& map, ClosureId closure, std::map<std::string, Robot>& robots,
                    const EngineOptions& options);

/// Takes every relation of a robot's patches out of the map, so that they lie alone, and returns them. Other
/// robots that stood on them are put back on their own patches.
std::vector<Relation> take_out(Map& map, const std::string& robot, std::map<std::string, Robot>& robots);

}  // namespace isthmus
