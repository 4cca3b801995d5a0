#include "server/wire/message/configuration_doubts.hpp"

#include "server/program/spelling.hpp"

namespace isthmus {
namespace {

std::string start_from_stranger(const std::string& robot, const std::string& with) {
  return "the start of " + robot + " is measured from " + with +
         ", which the configuration does not name: it takes effect once " + with + "_ROBOT comes";
}

}  // namespace

std::vector<std::string> configuration_doubts(const Configuration& configuration) {
  std::vector<std::string> doubts;
  for (const auto& [name, robot] : configuration.robots) {
    if (!robot.start || configuration.robots.contains(robot.start->with)) continue;
    const std::string& with = robot.start->with;
    std::vector<std::string> others;
    for (const auto& [other, unused] : configuration.robots)
      if (other != name) others.push_back(other);
    doubts.push_back(start_from_stranger(name, with) + did_you_mean(with, others));
  }
  return doubts;
}

}  // namespace isthmus
