#include "tools/replay/summary.hpp"

#include <nlohmann/json.hpp>

#include "server/output/tables/islands.hpp"
#include "tools/text/printed.hpp"

namespace isthmus {
namespace {

using Json = nlohmann::ordered_json;

/// "no_overlap 3, no_odometry 1".
template <HasWords Enum>
std::string counts(const std::map<Enum, std::int64_t>& by_reason) {
  std::string text;
  for (const auto& [reason, count] : by_reason) {
    text += (text.empty() ? "" : ", ") + std::string(word(reason)) + " " + std::to_string(count);
  }
  return text.empty() ? "none" : text;
}

double share_matched(const Counters& counters) {
  if (counters.scans == 0) return 0;
  return static_cast<double>(counters.scans_matched) / static_cast<double>(counters.scans);
}

double log_duration_s(const Counters& counters) {
  return 1e-6 * static_cast<double>(counters.last_receive_utime - counters.first_receive_utime);
}

Json quantiles_ms(const LatencyHistogram& times) {
  return {{"p50", 1e3 * times.quantile_s(0.5)},
          {"p99", 1e3 * times.quantile_s(0.99)},
          {"max", 1e3 * times.max_s()}};
}

/// By robot; robots with nothing wrong are left out.
Json warnings(const MapCopy& map) {
  Json object = Json::object();
  for (const HealthRecord& robot : map.health)
    for (const HealthWarning& warning : robot.warnings) object[robot.robot].push_back(warning.text);
  return object;
}

}  // namespace

std::string summary_text(const ReplayResult& result, const MapCopy& map) {
  const Counters& c = map.counters;
  const RunCost& cost = result.cost;
  const double second_ms = 1e3 * result.scan_cost.mean_s(0.1, 0.2);
  const double last_ms = 1e3 * result.scan_cost.mean_s(0.9, 1.0);
  const long long scans = c.scans;
  std::string text = printed_line("scans      %lld, %.2f %% matched", scans, 100 * share_matched(c));
  text += "predicted  " + counts(c.scans_predicted) + "\n";
  text += "dropped    " + counts(c.dropped) + "\n";
  text += printed_line("map        %zu patches, %zu tags, %zu relations, %zu islands, %zu closures",
                       patch_count(map), map.patches.size() - patch_count(map), map.graph.relations().size(),
                       rank_islands(map).patches.size(), map.closures.size());
  text += printed_line("time       %.1f s of log in %.2f s, %.2f s CPU; peak memory %.0f MB",
                       log_duration_s(c), cost.wall_s, cost.cpu_s, cost.peak_rss_mb);
  text += printed_line("event      p50 %.3f ms, p99 %.3f ms, max %.3f ms",
                       1e3 * cost.event_latency.quantile_s(0.5), 1e3 * cost.event_latency.quantile_s(0.99),
                       1e3 * cost.event_latency.max_s());
  text +=
      printed_line("event CPU  p50 %.3f ms, p99 %.3f ms, max %.3f ms", 1e3 * result.event_cpu.quantile_s(0.5),
                   1e3 * result.event_cpu.quantile_s(0.99), 1e3 * result.event_cpu.max_s());
  text += printed_line("per scan   %.3f ms CPU in the second tenth, %.3f ms in the last: %.2f times",
                       second_ms, last_ms, second_ms > 0 ? last_ms / second_ms : 0.0);
  for (const HealthRecord& robot : map.health)
    for (const HealthWarning& warning : robot.warnings) text += "warning    " + warning.text + "\n";
  return text + "map_sha256 " + map_sha256(map) + "\n";
}

std::string summary_json(const ReplayResult& result, const MapCopy& map) {
  const Counters& c = map.counters;
  const RunCost& cost = result.cost;
  const Json json = {{"messages", result.messages},
                     {"skipped_bytes", result.skipped_bytes},
                     {"missing_events", result.missing_events},
                     {"scans", c.scans},
                     {"matched_share", share_matched(c)},
                     {"scans_predicted", Json(by_word(c.scans_predicted))},
                     {"dropped", Json(by_word(c.dropped))},
                     {"patches", patch_count(map)},
                     {"tags", map.patches.size() - patch_count(map)},
                     {"relations", map.graph.relations().size()},
                     {"islands", rank_islands(map).patches.size()},
                     {"closures", map.closures.size()},
                     {"warnings", warnings(map)},
                     {"log_duration_s", log_duration_s(c)},
                     {"wall_s", cost.wall_s},
                     {"cpu_s", cost.cpu_s},
                     {"peak_rss_mb", cost.peak_rss_mb},
                     {"event_latency_ms", quantiles_ms(cost.event_latency)},
                     {"event_cpu_ms", quantiles_ms(result.event_cpu)},
                     {"scan_cost_ms",
                      {{"second_tenth", 1e3 * result.scan_cost.mean_s(0.1, 0.2)},
                       {"last_tenth", 1e3 * result.scan_cost.mean_s(0.9, 1.0)}}},
                     {"map_sha256", map_sha256(map)}};
  return json.dump(2) + "\n";
}

}  // namespace isthmus
