#include "server/wire/page/past_maps.hpp"

#include <algorithm>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <utility>

#include "server/wire/journal/journal_files.hpp"
#include "server/wire/journal/journal_view.hpp"
#include "server/wire/page/map/trails.hpp"
#include "server/wire/page/texts/page_texts.hpp"

namespace isthmus {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::json;

LiveView view_of(const MapCopy& map) { return {std::make_shared<const MapCopy>(map), {}, 0, false}; }

/// Of a snapshot's newest scan: tenths of a second after the first patch of the map as it is now.
std::int32_t newest_scan(const SnapshotSummary& summary, const ShownMap& now) {
  std::int32_t newest = 0;
  const std::vector<Session>& sessions = now.map().sessions;
  for (const auto& [number, utime] : summary.scan_utime) {
    if (number < 0 || static_cast<std::size_t>(number) >= sessions.size()) continue;
    const std::string& robot = sessions[static_cast<std::size_t>(number)].robot;
    newest = std::max(newest, tenths_after_first(now, now.clocks.server_utime(robot, utime)));
  }
  return newest;
}

/// Put together of texts that are JSON.
std::string past_text(int snapshot, const SnapshotSummary& summary, const ShownMap& shown,
                      const TileStore& tiles) {
  const Trails trails = trails_of(shown);
  const std::pair<const char*, std::string> parts[] = {{"islands", islands_text(shown, tiles.islands())},
                                                       {"robots", robots_text(trails, shown)},
                                                       {"trails", trails_text(trails, shown)},
                                                       {"tags", tags_text(shown)},
                                                       {"annotations", annotations_text(shown)},
                                                       {"closures", closures_text(shown)}};
  const Json head = {{"snapshot", snapshot},
                     {"time", 1e-6 * static_cast<double>(summary.last_utime)},
                     {"events", summary.events}};
  std::string text = head.dump();
  text.pop_back();
  for (const auto& [name, part] : parts) text.append(",\"").append(name).append("\":").append(part);
  return text + "}";
}

/// Without the directory, which is nobody's business but the server's.
std::string without_directory(std::string text, const std::string& directory) {
  const std::string prefix = (fs::path(directory) / "").string();
  for (std::size_t at = text.find(prefix); at != std::string::npos; at = text.find(prefix))
    text.erase(at, prefix.size());
  return text;
}

}  // namespace

PastMap::PastMap(int of_snapshot, const SnapshotSummary& summary, const MapCopy& copy, std::int64_t version)
    : snapshot(of_snapshot), shown(shown_map(view_of(copy), nullptr, version)), tiles(version) {
  tiles.update(shown.map());
  text = std::make_shared<const std::string>(past_text(snapshot, summary, shown, tiles));
}

PastMaps::PastMaps(std::string directory, std::int64_t first_version)
    : directory_(std::move(directory)), first_version_(first_version) {}

std::vector<int> PastMaps::snapshots() const {
  std::vector<int> numbers;
  if (directory_.empty()) return numbers;
  try {
    for (const auto& [number, path] : list_journal(directory_).snapshots) numbers.push_back(number);
  } catch (const std::runtime_error&) {
    // It is gone; the journal says so itself.
  }
  return numbers;
}

std::string PastMaps::list(const ShownMap& now) {
  Json list = Json::array();
  const std::vector<int> numbers = snapshots();
  const std::lock_guard lock(indexing_);
  std::erase_if(entries_, [&](const auto& entry) { return !std::ranges::count(numbers, entry.first); });
  for (const int number : numbers) {
    const Entry entry = entry_of(number, snapshot_path(directory_, number));
    if (!entry.error.empty()) {
      list.push_back({{"snapshot", number}, {"error", entry.error}});
      continue;
    }
    list.push_back({{"snapshot", number},
                    {"time", 1e-6 * static_cast<double>(entry.summary.last_utime)},
                    {"events", entry.summary.events},
                    {"end", newest_scan(entry.summary, now)}});
  }
  return list.dump(-1, ' ', false, Json::error_handler_t::replace);
}

/// As it was looked at before, if the file is still that one.
PastMaps::Entry PastMaps::entry_of(int snapshot, const std::string& path) {
  std::error_code gone;
  const auto written = fs::last_write_time(path, gone);
  const auto known = entries_.find(snapshot);
  if (known != entries_.end() && !gone && known->second.written == written) return known->second;
  Entry entry;
  entry.written = written;
  try {
    entry.summary = read_snapshot_summary(path);
    const std::string foreign = why_foreign(entry.summary.place, view_journal(directory_), snapshot);
    if (!foreign.empty()) throw std::runtime_error(path + ": " + foreign);
  } catch (const std::exception& error) {
    entry.error = without_directory(error.what(), directory_);
  }
  return entries_[snapshot] = entry;
}

PastMaps::Found PastMaps::find(int snapshot) {
  if (auto map = kept(snapshot)) return {std::move(map), 200, ""};
  const std::unique_lock lock(reading_, std::try_to_lock);
  if (!lock) return {nullptr, 503, "another map of the past is being read"};
  if (auto map = kept(snapshot)) return {std::move(map), 200, ""};
  Found found = read(snapshot);
  if (!found.map) return found;
  const std::lock_guard keeping(keeping_);
  kept_.push_front(found.map);
  if (kept_.size() > max_kept) kept_.pop_back();
  return found;
}

std::shared_ptr<PastMap> PastMaps::kept(int snapshot) {
  const std::lock_guard lock(keeping_);
  const auto found = std::ranges::find(kept_, snapshot, [](const auto& map) { return map->snapshot; });
  if (found == kept_.end()) return nullptr;
  kept_.splice(kept_.begin(), kept_, found);
  return kept_.front();
}

PastMaps::Found PastMaps::read(int snapshot) {
  const std::string path = snapshot_path(directory_, snapshot);
  const auto gone = [&]() -> Found {
    return {nullptr, 404, "there is no snapshot " + std::to_string(snapshot) + ", or no longer"};
  };
  if (std::ranges::count(snapshots(), snapshot) == 0) return gone();
  Entry entry;
  {
    const std::lock_guard lock(indexing_);
    entry = entry_of(snapshot, path);
  }
  if (entry.error.empty()) {
    try {
      const ServedMap served = read_snapshot(path).map;
      if (served.features) throw std::runtime_error("a map of features, which the page does not show");
      const MapCopy map = served.engine.copy();
      return {std::make_shared<PastMap>(snapshot, entry.summary, map, first_version_), 200, ""};
    } catch (const std::exception& error) {
      entry.error = without_directory(error.what(), directory_);
    }
  }
  // It may have been deleted meanwhile, as all are in their time.
  if (std::ranges::count(snapshots(), snapshot) == 0) return gone();
  return {nullptr, 500, entry.error};
}

}  // namespace isthmus
