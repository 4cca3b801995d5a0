#include "tools/simulate/evidence/evidence.hpp"

#include <cmath>
#include <numbers>
#include <optional>

#include "server/output/format/csv.hpp"
#include "tools/simulate/truth/true_patches.hpp"

namespace isthmus {
namespace {

constexpr double false_closure_m = 1;
constexpr double false_closure_rad = 20 * std::numbers::pi / 180;

std::size_t index(PatchId id) { return static_cast<std::size_t>(id.value); }

}  // namespace

bool LabelledClosure::is_true() const { return off_m <= false_closure_m && off_rad <= false_closure_rad; }

std::vector<LabelledClosure> label_closures(const std::string& run, const MapCopy& map,
                                            const std::vector<RobotTruth>& truth) {
  const std::vector<std::optional<TruePatch>> patches = true_patches(map, truth);
  std::vector<LabelledClosure> labelled;
  for (const ClosureRecord& closure : map.closures) {
    const Joining& says = closure.joining;
    if (says.point || closure.account.supporters == 0) continue;
    const auto &first = patches[index(says.first)], &second = patches[index(says.second)];
    if (!first || !second) continue;
    const Pose true_pose = ominus(second->world_from_patch, first->world_from_patch);
    const Pose& said = says.first_from_second;
    labelled.push_back({run, closure, std::hypot(said.x - true_pose.x, said.y - true_pose.y),
                        std::abs(wrap_angle(said.yaw - true_pose.yaw))});
  }
  return labelled;
}

void write_labelled_closures(const std::vector<LabelledClosure>& closures, const std::string& file) {
  CsvFile csv(
      file,
      "run,id,kind,proposed_by,state,reason,true,off_m,off_rad,supporters,two_way,compared,matched,cost,"
      "contradiction,own_contradiction,way_m,width_m,own_m,border_contradiction,look_alikes,"
      "sighting_log_odds,revisit_log_odds,shared_log_odds,fit_log_odds,blamed,blamed_log_odds,log_odds");
  for (const LabelledClosure& one : closures) {
    const ClosureRecord& c = one.closure;
    const TrialAccount& a = c.account;
    csv.row(one.run, c.id, word(c.kind), c.from_scans ? "scans" : "sightings", word(c.state), word(c.reason),
            one.is_true() ? 1 : 0, one.off_m, one.off_rad, a.supporters, a.two_way ? 1 : 0, a.compared,
            a.matched, a.cost, a.contradiction, a.own_contradiction, a.way_m, a.width_m, a.own_m,
            a.border_contradiction, a.look_alikes, a.sighting_log_odds, a.revisit_log_odds, a.shared_log_odds,
            a.fit_log_odds, a.blamed, a.blamed_log_odds, a.log_odds());
  }
  csv.commit();
}

}  // namespace isthmus
