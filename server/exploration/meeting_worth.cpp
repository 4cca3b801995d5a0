#include "server/exploration/meeting_worth.hpp"

#include <memory>
#include <tuple>

#include "server/exploration/routes.hpp"

namespace isthmus {
namespace {

constexpr double as_likely = 0.5;

double known_m2(Planner& planner, const Explorer& explorer) {
  const IslandId island = planner.map().graph.island(explorer.pose.patch);
  const auto roadmap = planner.roadmap(island, explorer.footprint);
  if (!roadmap) return 0;
  const Ground& ground = roadmap->ground();
  double cells = 0;
  for (NodeId node = 0; node < static_cast<NodeId>(ground.size()); ++node)
    cells += !ground.layer(node).occupied && !ground.layer(node).is_gap;
  return cells * ground_cell_m * ground_cell_m;
}

double way_m(Planner& planner, const Explorer& explorer, const ManifoldPose& place) {
  const Path path = planner.path({explorer.pose, place, explorer.footprint});
  return path.refusal == Refusal::none ? path.length_m : no_way;
}

}  // namespace

MeetingWorth worth_of_meeting(Planner& planner, const MeetingRecord& meeting, const Explorer& a,
                              bool a_has_work, const Explorer& b, bool b_has_work,
                              const ExplorationOptions& options) {
  MeetingWorth worth;
  for (const auto& [explorer, place, has_work] :
       {std::tuple(&a, &meeting.a.pose, a_has_work), std::tuple(&b, &meeting.b.pose, b_has_work)}) {
    const double there_m = way_m(planner, *explorer, *place);
    if (there_m == no_way || has_work) worth.cost_m += 2 * there_m;
    worth.saved_m += as_likely * options.work_m_per_m2 * known_m2(planner, *explorer);
  }
  return worth;
}

}  // namespace isthmus
