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

/// How far what is said of two patches is from the truth; nothing where that is not known.
std::optional<Pose> off_by(const std::vector<std::optional<TruePatch>>& patches, PatchId first,
                           PatchId second, const Pose& first_from_second) {
  const auto& of_first = patches[static_cast<std::size_t>(first.value)];
  const auto& of_second = patches[static_cast<std::size_t>(second.value)];
  if (!of_first || !of_second) return std::nullopt;
  const Pose truth = ominus(of_second->world_from_patch, of_first->world_from_patch);
  return Pose{first_from_second.x - truth.x, first_from_second.y - truth.y,
              wrap_angle(first_from_second.yaw - truth.yaw)};
}

bool is_near(double off_m, double off_rad) {
  return off_m <= false_closure_m && off_rad <= false_closure_rad;
}

}  // namespace

bool LabelledClosure::is_true() const { return is_near(off_m, off_rad); }

std::vector<LabelledClosure> label_closures(const std::string& run, const MapCopy& map,
                                            const std::vector<RobotTruth>& truth) {
  const std::vector<std::optional<TruePatch>> patches = true_patches(map, truth);
  std::vector<LabelledClosure> labelled;
  for (const ClosureRecord& closure : map.closures) {
    const Joining& says = closure.joining;
    if (says.point || closure.account.supporters == 0) continue;
    if (const auto off = off_by(patches, says.first, says.second, says.first_from_second))
      labelled.push_back({run, closure, std::hypot(off->x, off->y), std::abs(off->yaw)});
  }
  return labelled;
}

std::vector<LabelledFind> label_finds(const std::string& run, const MapCopy& map,
                                      const std::vector<RobotTruth>& truth) {
  const std::vector<std::optional<TruePatch>> patches = true_patches(map, truth);
  std::vector<LabelledFind> labelled;
  for (const FindRecord& find : map.finds)
    if (const auto off = off_by(patches, find.anchor, find.query, find.anchor_from_query))
      labelled.push_back({run, find, is_near(std::hypot(off->x, off->y), std::abs(off->yaw))});
  return labelled;
}

void write_labelled_finds(const std::vector<LabelledFind>& finds, const std::string& file) {
  CsvFile csv(file, "run,true,way_m,search_score,carrier_score,seen_again,look_alikes,log_odds");
  for (const auto& [run, find, is_true] : finds)
    csv.row(run, is_true ? 1 : 0, find.way_m, find.search_score, find.carrier_score, find.seen_again,
            find.look_alikes, find.log_odds);
  csv.commit();
}

void write_labelled_closures(const std::vector<LabelledClosure>& closures, const std::string& file) {
  CsvFile csv(
      file,
      "run,id,kind,proposed_by,state,reason,true,off_m,off_rad,supporters,two_way,compared,matched,cost,"
      "contradiction,own_contradiction,way_m,unmatched_m,width_m,own_m,border_contradiction,look_alikes,"
      "prior_log_odds,sighting_log_odds,revisit_log_odds,shared_log_odds,fit_log_odds,layers_before,layers_"
      "after,"
      "layers_log_odds,blamed,blamed_log_odds,"
      "log_odds");
  for (const LabelledClosure& one : closures) {
    const ClosureRecord& c = one.closure;
    const TrialAccount& a = c.account;
    csv.row(one.run, c.id, word(c.kind), c.from_scans ? "scans" : "sightings", word(c.state), word(c.reason),
            one.is_true() ? 1 : 0, one.off_m, one.off_rad, a.supporters, a.two_way ? 1 : 0, a.compared,
            a.matched, a.cost, a.contradiction, a.own_contradiction, a.way_m, a.unmatched_m, a.width_m,
            a.own_m, a.border_contradiction, a.look_alikes, a.prior_log_odds, a.sighting_log_odds,
            a.revisit_log_odds, a.shared_log_odds, a.fit_log_odds, a.layers_before, a.layers_after,
            a.layers_log_odds, a.blamed, a.blamed_log_odds, a.log_odds());
  }
  csv.commit();
}

}  // namespace isthmus
