#include "server/output/report.hpp"

#include <nlohmann/json.hpp>
#include <set>

#include "server/engine/record/self_check.hpp"
#include "server/output/format/atomic_file.hpp"
#include "server/output/tables/trajectories.hpp"

namespace isthmus {
namespace {

using Json = nlohmann::ordered_json;

double seconds_between(std::int64_t from_utime, std::int64_t to_utime) {
  return 1e-6 * (static_cast<double>(to_utime) - static_cast<double>(from_utime));
}

Json account_of(const TrialAccount& account) {
  Json rests_on = Json::array();
  for (const ClosureId id : account.rests_on) rests_on.push_back(id.value);
  return {{"supporters", account.supporters},
          {"two_way", account.two_way},
          {"compared", account.compared},
          {"matched", account.matched},
          {"cost", account.cost},
          {"contradiction", account.contradiction},
          {"own_contradiction", account.own_contradiction},
          {"way_m", account.way_m},
          {"unmatched_m", account.unmatched_m},
          {"width_m", account.width_m},
          {"own_m", account.own_m},
          {"border_contradiction", account.border_contradiction},
          {"look_alikes", account.look_alikes},
          {"prior_log_odds", account.prior_log_odds},
          {"sighting_log_odds", account.sighting_log_odds},
          {"revisit_log_odds", account.revisit_log_odds},
          {"shared_log_odds", account.shared_log_odds},
          {"fit_log_odds", account.fit_log_odds},
          {"layers_before", account.layers_before},
          {"layers_after", account.layers_after},
          {"layers_log_odds", account.layers_log_odds},
          {"rests_on", std::move(rests_on)},
          {"blamed", account.blamed},
          {"blamed_closure", account.blamed_closure.value},
          {"blamed_log_odds", account.blamed_log_odds},
          {"log_odds", account.log_odds()}};
}

Json closures(const MapCopy& map) {
  const std::int64_t first_utime = map.counters.first_receive_utime;
  Json list = Json::array();
  for (const ClosureRecord& closure : map.closures) {
    list.push_back({{"id", closure.id.value},
                    {"kind", word(closure.kind)},
                    {"state", word(closure.state)},
                    {"proposed_by", closure.from_scans ? "scans" : "sightings"},
                    {"utime", closure.utime},
                    {"robots", closure.robots},
                    {"reason", word(closure.reason)},
                    {"patches_touched", closure.patches_touched},
                    {"work_steps", closure.work_steps},
                    {"evidence", account_of(closure.account)},
                    {"event_time_s", seconds_between(closure.start_utime, closure.end_utime)},
                    {"start_s", seconds_between(first_utime, closure.start_utime)},
                    {"end_s", seconds_between(first_utime, closure.end_utime)}});
  }
  return list;
}

/// The search for places that a robot's scans may show again.
Json hypotheses(const HypothesisCounts& counts) {
  return {{"queries", counts.queries},
          {"queries_put_off", counts.queries_put_off},
          {"places_searched", counts.places_searched},
          {"ambiguous", counts.ambiguous},
          {"finds", counts.finds},
          {"proposed", counts.proposed}};
}

Json sessions(const MapCopy& map, const RankedIslands& islands) {
  Json list = Json::array();
  for (const Session& session : map.sessions) {
    list.push_back({{"number", session.number},
                    {"robot", session.robot},
                    {"island", islands.rank(session.first_patch)},
                    {"from_utime", session.from_utime},
                    {"to_utime", session.to_utime}});
  }
  return list;
}

Json island_list(const MapCopy& map, const RankedIslands& islands) {
  Json list = Json::array();
  for (std::size_t k = 0; k < islands.patches.size(); ++k) {
    const std::vector<PatchId>& patches = islands.patches[k];
    std::set<std::string> robots;
    for (const PatchId id : patches) robots.insert(map.patches[static_cast<std::size_t>(id.value)]->robot);
    list.push_back({{"id", map.graph.island(patches.front()).value},
                    {"patches", patches.size()},
                    {"tags", islands.tags[k].size()},
                    {"robots", robots}});
  }
  return list;
}

Json latency_ms(const LatencyHistogram& latency) {
  return {{"p50", 1e3 * latency.quantile_s(0.5)},
          {"p99", 1e3 * latency.quantile_s(0.99)},
          {"max", 1e3 * latency.max_s()}};
}

/// What looks wrong, by robot; robots with nothing of the kind are left out.
Json warnings(const MapCopy& map) {
  Json object = Json::object();
  for (const HealthRecord& robot : map.health)
    for (const HealthWarning& warning : robot.warnings)
      object[robot.robot].push_back({{"key", warning.key}, {"text", warning.text}});
  return object;
}

/// Where the map contradicts itself.
Json contradictions(const MapCopy& map) {
  Json list = Json::array();
  for (const SelfContradiction& found : self_contradictions(map)) {
    std::vector<std::int32_t> patches;
    for (const PatchId id : found.patches) patches.push_back(id.value);
    list.push_back({{"island", found.island.value},
                    {"x_m", found.centre_m.x()},
                    {"y_m", found.centre_m.y()},
                    {"pairs", found.pairs},
                    {"robots", found.robots},
                    {"patches", patches}});
  }
  return list;
}

Json health(const MapCopy& map) {
  Json object = Json::object();
  for (const HealthRecord& robot : map.health) {
    const HealthFigures& f = robot.figures;
    object[robot.robot] = {{"clock_ahead_s", f.clock_ahead_s ? Json(*f.clock_ahead_s) : Json()},
                           {"odometry_messages", f.odometry_messages},
                           {"odometry_way_m", f.odometry_way_m},
                           {"scans", f.scans},
                           {"scans_without_return", f.scans_without_return},
                           {"scans_with_few_returns", f.scans_with_few_returns},
                           {"most_beams", f.max_beams},
                           {"scans_changed", f.scans_changed},
                           {"scans_changed_still", f.scans_changed_still},
                           {"scans_matched", f.scans_matched},
                           {"laser_way_m", f.way.laser},
                           {"laser_turn_rad", f.turn.laser},
                           {"odometry_explains_way", f.way.explained()},
                           {"odometry_explains_turns", f.turn.explained()},
                           {"way_ratio", f.way.ratio()},
                           {"turn_ratio", f.turn.ratio()},
                           {"direction_rad", f.direction_rad},
                           {"direction_steadiness", f.direction_steadiness},
                           {"turn_correlation", f.turn_correlation},
                           {"best_lag_scans", f.best_lag_scans},
                           {"off_at_best_lag", f.off_at_best_lag},
                           {"scan_delay_s", robot.scan_delay_s},
                           {"offset_scans", f.offset_scans ? Json(*f.offset_scans) : Json()},
                           {"off_at_offset", f.off_at_offset}};
  }
  return object;
}

/// A map of counts; an empty one is an object too.
template <HasWords Enum>
Json counts(const std::map<Enum, std::int64_t>& by_reason) {
  Json object = Json::object();
  for (const auto& [reason, count] : by_reason) object[std::string(word(reason))] = count;
  return object;
}

Json counts_by_robot(const std::map<std::string, std::map<DropReason, std::int64_t>>& by_robot) {
  Json object = Json::object();
  for (const auto& [robot, by_reason] : by_robot) object[robot] = counts(by_reason);
  return object;
}

}  // namespace

std::string report_json(const MapCopy& map, const RankedIslands& islands, const RunCost& cost) {
  const Counters& counters = map.counters;
  const double log_duration_s = seconds_between(counters.first_receive_utime, counters.last_receive_utime);
  const Json report = {{"events", counters.events},
                       {"scans", counters.scans},
                       {"scans_matched", counters.scans_matched},
                       {"scans_predicted", counts(counters.scans_predicted)},
                       {"sightings", counters.sightings},
                       {"dropped", counts(counters.dropped)},
                       {"dropped_by_robot", counts_by_robot(counters.dropped_by_robot)},
                       {"patches", patch_count(map)},
                       {"tags", map.patches.size() - patch_count(map)},
                       {"relations", map.graph.relations().size()},
                       {"islands", islands.patches.size()},
                       {"island_list", island_list(map, islands)},
                       {"trajectory_rows", map.trajectory_rows},
                       {"trajectory_rows_parted", count_parted_rows(map)},
                       {"sessions", sessions(map, islands)},
                       {"warnings", warnings(map)},
                       {"health", health(map)},
                       {"contradictions", contradictions(map)},
                       {"closures", closures(map)},
                       {"hypotheses", hypotheses(map.hypotheses)},
                       {"log_duration_s", log_duration_s},
                       {"wall_s", cost.wall_s},
                       {"cpu_s", cost.cpu_s},
                       {"realtime_factor", cost.wall_s > 0 ? log_duration_s / cost.wall_s : 0.0},
                       {"event_latency_ms", latency_ms(cost.event_latency)},
                       {"peak_rss_mb", cost.peak_rss_mb},
                       {"finish_s", cost.finish_s},
                       {"finished", cost.finished},
                       {"map_sha256", map_sha256(map)}};
  // Names may hold bytes that are no UTF-8; those are replaced, for a report must not fail on them.
  return report.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

void write_report(const MapCopy& map, const RankedIslands& islands, const RunCost& cost,
                  const std::string& path) {
  AtomicFile file(path);
  file.write(report_json(map, islands, cost));
  file.commit();
}

}  // namespace isthmus
