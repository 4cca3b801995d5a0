#pragma once

#include <map>
#include <string>
#include <vector>

#include "server/engine/robot.hpp"

namespace isthmus {

/// Takes an accepted closure back: every relation whose origin it is goes, and of the matches made since,
/// those that only it made possible. The rest is refitted, islands part where nothing else joins them, and
/// robots that stood on the other side are put back on their own.
void withdraw(Map& map, ClosureId closure, std::map<std::string, Robot>& robots);

/// Takes every relation of a robot's patches out of the map, so that they lie alone, and returns them. Other
/// robots that stood on them are put back on their own patches.
std::vector<Relation> take_out(Map& map, const std::string& robot, std::map<std::string, Robot>& robots);

}  // namespace isthmus
