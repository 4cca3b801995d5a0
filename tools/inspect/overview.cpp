#include "tools/inspect/overview.hpp"

#include <algorithm>
#include <array>
#include <cstdio>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <vector>

namespace isthmus {
namespace {

using Json = nlohmann::ordered_json;
using Row = std::vector<std::string>;

/// Columns as wide as their widest cell, two blanks apart.
std::string table(const std::vector<Row>& rows) {
  std::vector<std::size_t> widths(rows.front().size(), 0);
  for (const Row& row : rows) {
    for (std::size_t i = 0; i < row.size(); ++i) widths[i] = std::max(widths[i], row[i].size());
  }
  std::string text;
  for (const Row& row : rows) {
    std::string line = " ";
    for (std::size_t i = 0; i < row.size(); ++i) {
      line += " " + row[i] + std::string(widths[i] - row[i].size() + 1, ' ');
    }
    line.erase(line.find_last_not_of(' ') + 1);
    text += line + "\n";
  }
  return text;
}

std::string decimal(double value, int decimals) {
  std::array<char, 64> text{};
  std::snprintf(text.data(), text.size(), "%.*f", decimals, value);
  return text.data();
}

std::string joined(const Json& names) {
  std::string text;
  for (const Json& name : names) text += (text.empty() ? "" : " ") + name.get<std::string>();
  return text;
}

std::string counts(const Json& by_reason) {
  std::string text;
  for (const auto& [reason, count] : by_reason.items()) {
    text += (text.empty() ? "" : ", ") + reason + " " + std::to_string(count.get<std::int64_t>());
  }
  return text.empty() ? "none" : text;
}

/// "12: accepted 8, refused 3 (no_overlap 3), waiting 1"
std::string sightings(const Json& report, const MeetingCounts& meetings) {
  std::string text = report.at("sightings").dump();
  const char* separator = ": ";
  for (const auto& [verdict, count] : meetings.sightings_by_verdict) {
    text += separator + std::string(word(verdict)) + " " + std::to_string(count);
    if (verdict == Verdict::refused) text += " (" + counts(Json(meetings.refused_by_reason)) + ")";
    separator = ", ";
  }
  return text;
}

std::string counters(const Json& report, const MeetingCounts& meetings) {
  const auto scans = report.at("scans").get<double>();
  const double share = scans > 0 ? report.at("scans_matched").get<double>() / scans : 0;
  const Json& latency = report.at("event_latency_ms");
  return table({{"map", report.at("map_sha256").get<std::string>()},
                {"events", report.at("events").dump() + " in " +
                               decimal(report.at("log_duration_s").get<double>(), 1) + " s"},
                {"scans", report.at("scans").dump() + ", " + decimal(100 * share, 2) + " % matched"},
                {"predicted", counts(report.at("scans_predicted"))},
                {"dropped", counts(report.at("dropped"))},
                {"sightings", sightings(report, meetings)},
                {"patches", report.at("patches").dump()},
                {"relations", report.at("relations").dump()},
                {"cost", decimal(report.at("cpu_s").get<double>(), 1) + " s CPU, " +
                             decimal(report.at("peak_rss_mb").get<double>(), 0) + " MB"},
                {"latency", decimal(latency.at("p50").get<double>(), 3) + " ms median, " +
                                decimal(latency.at("p99").get<double>(), 3) + " ms 99 %, " +
                                decimal(latency.at("max").get<double>(), 3) + " ms at most"}});
}

std::string islands(const Json& report) {
  std::vector<Row> rows = {{"island", "id", "patches", "robots"}};
  for (const Json& island : report.at("island_list")) {
    rows.push_back({std::to_string(rows.size() - 1), island.at("id").dump(), island.at("patches").dump(),
                    joined(island.at("robots"))});
  }
  return table(rows);
}

std::string sessions(const Json& report) {
  std::vector<Row> rows = {{"session", "robot", "island", "from s", "to s"}};
  for (const Json& session : report.at("sessions")) {
    const int island = session.at("island").get<int>();
    rows.push_back({session.at("number").dump(), session.at("robot").get<std::string>(),
                    island < 0 ? "-" : std::to_string(island),
                    decimal(1e-6 * session.at("from_utime").get<double>(), 3),
                    decimal(1e-6 * session.at("to_utime").get<double>(), 3)});
  }
  return table(rows);
}

// What was found on its trial; a map of an older version does not say.
std::string evidence(const Json& closure) {
  const Json found = closure.value("evidence", Json::object());
  if (found.value("compared", 0) == 0) return "";
  std::string text = found.at("matched").dump() + " of " + found.at("compared").dump() + " match";
  if (found.at("way_m").get<double>() > 0 && found.contains("log_odds"))
    text += ", log-odds " + decimal(found.at("log_odds").get<double>(), 1);
  if (found.value("blamed_closure", -1) >= 0) {
    text += ", against closure " + found.at("blamed_closure").dump();
  } else if (found.value("blamed", 0) > 0) {
    text += ", against " + found.at("blamed").dump() + " relations";
  }
  return text;
}

std::string closures(const Json& report, const MeetingCounts& meetings) {
  if (report.at("closures").empty()) return "  none\n";
  std::vector<Row> rows = {{"closure", "kind", "state", "at s", "robots", "evidence", "sightings",
                            "relations", "dependents", "reason"}};
  for (const Json& closure : report.at("closures")) {
    const auto known = meetings.by_closure.find(closure.at("id").get<std::int64_t>());
    const ClosureParts parts = known == meetings.by_closure.end() ? ClosureParts{} : known->second;
    rows.push_back({closure.at("id").dump(), closure.at("kind").get<std::string>(),
                    closure.at("state").get<std::string>(),
                    decimal(1e-6 * closure.at("utime").get<double>(), 3), joined(closure.at("robots")),
                    evidence(closure), std::to_string(parts.sightings), std::to_string(parts.relations),
                    std::to_string(parts.dependents), closure.at("reason").get<std::string>()});
  }
  return table(rows);
}

/// Where the map contradicts itself; a map of an older version does not say.
std::string contradictions(const Json& report) {
  const Json found = report.value("contradictions", Json::array());
  if (found.empty()) return "";
  std::vector<Row> rows = {{"island id", "x m", "y m", "patches", "pairs", "robots"}};
  for (const Json& one : found)
    rows.push_back({one.at("island").dump(), decimal(one.at("x_m").get<double>(), 1),
                    decimal(one.at("y_m").get<double>(), 1), std::to_string(one.at("patches").size()),
                    one.at("pairs").dump(), joined(one.at("robots"))});
  return "\ncontradictions of the map with itself\n" + table(rows);
}

}  // namespace

std::string overview(const std::string& report_json, const MeetingCounts& meetings, const std::string& file) {
  try {
    const Json report = Json::parse(report_json);
    return counters(report, meetings) + "\nislands\n" + islands(report) + "\nsessions\n" + sessions(report) +
           "\nclosures\n" + closures(report, meetings) + contradictions(report);
  } catch (const Json::exception& error) {
    throw std::runtime_error(file + ": not a report of Isthmus: " + error.what());
  }
}

}  // namespace isthmus
