#include "tools/evaluate/failure.hpp"

namespace isthmus {
namespace {

bool matches_no_relation(const std::map<std::string, RelationErrors>& relations) {
  for (const auto& [kind, errors] : relations) {
    if (errors.count > 0) return false;
  }
  return !relations.empty();
}

}  // namespace

std::string failure_of(const Evaluation& evaluation) {
  if (evaluation.pose_graph && !evaluation.pose_graph->failure.empty()) return evaluation.pose_graph->failure;
  if (matches_no_relation(evaluation.relations))
    return "no relation of the truth matches the map: is it the truth of another run?";
  if (evaluation.absolute && evaluation.absolute->islands.empty())
    return "no pose of the truth matches the map: is it the truth of another run?";
  return "";
}

}  // namespace isthmus
