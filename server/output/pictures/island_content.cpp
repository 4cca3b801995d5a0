#include "server/output/pictures/island_content.hpp"

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <limits>
#include <set>

#include "server/output/format/number.hpp"
#include "server/output/pictures/marks.hpp"
#include "server/output/tables/trajectories.hpp"

namespace isthmus {
namespace {

/// 1973-03-03: earlier stamps are taken for times since a start.
constexpr std::int64_t first_date_utime = 100'000'000'000'000;
/// More would be a list and no legend.
constexpr std::size_t max_robots_in_legend = 40;
constexpr std::size_t max_named_loops = 60;
constexpr std::size_t max_named_merges = 80;

std::string date_text(std::int64_t utime) {
  using namespace std::chrono;
  const sys_time<microseconds> time{microseconds(utime)};
  const auto day = floor<days>(time);
  const year_month_day date(day);
  const hh_mm_ss clock(floor<std::chrono::seconds>(time - day));
  char text[64];
  std::snprintf(text, sizeof text, "%04d-%02u-%02u %02d:%02d:%02d", static_cast<int>(date.year()),
                static_cast<unsigned>(date.month()), static_cast<unsigned>(date.day()),
                static_cast<int>(clock.hours().count()), static_cast<int>(clock.minutes().count()),
                static_cast<int>(clock.seconds().count()));
  return text;
}

void find_robots(const MapCopy& map, const RankedIslands& islands, std::vector<IslandContent>& contents) {
  std::map<std::string, std::size_t> index;
  for (const std::string& robot : robots_as_they_came(map)) index.emplace(robot, index.size());
  std::vector<std::set<std::size_t>> robots(contents.size());
  for (const PatchPtr& patch : map.patches) {
    const int k = islands.rank(patch->id);
    const auto robot = index.find(patch->robot);
    if (k >= 0 && robot != index.end()) robots[static_cast<std::size_t>(k)].insert(robot->second);
  }
  for (const Session& session : map.sessions) {
    const int k = islands.rank(session.first_patch);
    if (k < 0) continue;
    IslandContent& content = contents[static_cast<std::size_t>(k)];
    robots[static_cast<std::size_t>(k)].insert(index.at(session.robot));
    content.from_utime = std::min(content.from_utime, session.from_utime);
    content.to_utime = std::max(content.to_utime, session.to_utime);
  }
  for (std::size_t k = 0; k < contents.size(); ++k)
    contents[k].robots.assign(robots[k].begin(), robots[k].end());
}

/// The first relation of each closure.
void find_closures(const MapCopy& map, const RankedIslands& islands, std::vector<IslandContent>& contents) {
  std::map<ClosureId, bool> is_merge;
  for (const ClosureRecord& record : map.closures) is_merge[record.id] = record.kind == ClosureKind::merge;
  std::set<ClosureId> shown;
  for (const auto& [id, relation] : map.graph.relations()) {
    const ClosureId closure = relation.origin.closure;
    const int k = islands.rank(relation.a);
    if (!closure.valid() || k < 0 || !shown.insert(closure).second) continue;
    contents[static_cast<std::size_t>(k)].closures.push_back(
        {closure, is_merge[closure], relation.a, relation.b});
  }
  for (IslandContent& content : contents)
    std::ranges::sort(content.closures, {}, [](const ShownClosure& one) { return one.id.value; });
}

}  // namespace

std::size_t IslandContent::loops() const {
  return static_cast<std::size_t>(std::ranges::count(closures, false, &ShownClosure::is_merge));
}

bool IslandContent::are_named(bool merges) const {
  return merges ? closures.size() - loops() <= max_named_merges : loops() <= max_named_loops;
}

std::vector<IslandContent> island_contents(const MapCopy& map, const RankedIslands& islands) {
  std::vector<IslandContent> contents(islands.patches.size());
  for (std::size_t k = 0; k < contents.size(); ++k) {
    contents[k].island = k;
    contents[k].islands = contents.size();
    contents[k].patches = islands.patches[k].size();
    contents[k].from_utime = std::numeric_limits<std::int64_t>::max();
  }
  find_robots(map, islands, contents);
  find_closures(map, islands, contents);
  for (const TagRecord& tag : map.tags) {
    const int k = islands.rank(tag.patch);
    if (k >= 0 && tag.position.allFinite()) contents[static_cast<std::size_t>(k)].tags.push_back(&tag);
  }
  return contents;
}

std::string counted(std::size_t count, const std::string& one, const std::string& many) {
  return std::to_string(count) + ' ' + (count == 1 ? one : many);
}

std::string time_text(std::int64_t from_utime, std::int64_t to_utime) {
  if (from_utime > to_utime) return "";
  const double lasts_s = 1e-6 * (static_cast<double>(to_utime) - static_cast<double>(from_utime));
  if (from_utime < first_date_utime)
    return "from " + fixed(1e-6 * static_cast<double>(from_utime), 1) + " s to " +
           fixed(1e-6 * static_cast<double>(to_utime), 1) + " s";
  return "from " + date_text(from_utime) + " UTC, " + fixed(lasts_s, 1) + " s";
}

SheetText sheet_text(const IslandContent& content) {
  SheetText text;
  text.title = "Island " + std::to_string(content.island) +
               (content.islands > 1 ? " of " + std::to_string(content.islands) : "");
  text.subtitle =
      counted(content.robots.size(), "robot", "robots") + ", " + counted(content.patches, "patch", "patches");
  if (!content.tags.empty()) text.subtitle += ", " + counted(content.tags.size(), "tag", "tags");
  if (!content.closures.empty())
    text.subtitle += ", " + counted(content.closures.size(), "closure", "closures");
  const std::string time = time_text(content.from_utime, content.to_utime);
  if (!time.empty()) text.subtitle += "; " + time;
  return text;
}

void add_robots(Legend& legend, const std::vector<std::size_t>& robots,
                const std::vector<std::string>& names) {
  const std::size_t shown = std::min(robots.size(), max_robots_in_legend);
  for (std::size_t i = 0; i < shown; ++i)
    legend.push_back(way_entry(names.at(robots[i]), way_style(robots[i])));
  if (shown < robots.size())
    legend.push_back(note_entry("and " + std::to_string(robots.size() - shown) + " more"));
}

Legend island_legend(const IslandContent& content, const std::vector<std::string>& names) {
  Legend legend;
  add_robots(legend, content.robots, names);
  if (!content.robots.empty()) {
    legend.push_back(start_entry());
    legend.push_back(end_entry());
  }
  legend.push_back(patch_entry());
  if (!content.tags.empty()) legend.push_back(tag_entry());
  const std::size_t loops = content.loops();
  if (loops > 0) legend.push_back(closure_entry(loop_style(loops), content.are_named(false)));
  if (loops < content.closures.size())
    legend.push_back(closure_entry({.is_merge = true}, content.are_named(true)));
  return legend;
}

}  // namespace isthmus
