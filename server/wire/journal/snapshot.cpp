#include "server/wire/journal/snapshot.hpp"

#include <algorithm>
#include <cstring>
#include <filesystem>
#include <numeric>
#include <stdexcept>

#include "server/engine/snapshot/snapshot_values.hpp"
#include "server/wire/file/checked_file.hpp"
#include "server/wire/journal/journal_files.hpp"

namespace isthmus {
namespace {

namespace fs = std::filesystem;

/// To be raised with every change of what is written: a test holds a file of each version.
constexpr FileForm snapshot_form{"isthmus-snapshot", 19};
constexpr FileForm trajectory_form{"isthmus-rows", 1};

constexpr std::size_t rows_at_once = 4096;

struct Content {
  JournalPlace place;  ///< first, and what a summary needs next: no more need be read for these
  std::vector<TrajectoryPart> trajectory;
  RobotMonitor monitor;
  std::int64_t events = 0;
  std::int64_t last_utime = 0;
  std::vector<std::int64_t> set_aside;
  std::vector<std::uint8_t> estimator;  ///< begins with the configuration's text, which tells what it is

  auto members() { return std::tie(place, trajectory, monitor, events, last_utime, set_aside, estimator); }
};

template <class Take>
void read_rows(const std::string& path, const TrajectoryPart& part, const Take& take) {
  const auto [bytes, sha256] = read_checked_file(path, trajectory_form);
  if (sha256 != part.sha256)
    throw std::runtime_error(path + ": holds other rows than the snapshot was made with");
  if (bytes.size() != part.rows * sizeof(TrajectoryRow))
    throw std::runtime_error(path + ": holds not as many rows as the snapshot needs");
  for (std::size_t at = 0; at < bytes.size(); at += sizeof(TrajectoryRow)) {
    TrajectoryRow row;
    std::memcpy(&row, bytes.data() + at, sizeof row);
    take(row);
  }
}

/// What a snapshot's content begins with.
template <class... Members>
void read_head(const std::string& path, Members&... members) {
  const std::vector<std::uint8_t> bytes = read_checked_file(path, snapshot_form).bytes;
  try {
    SnapshotReader reader(bytes);
    reader(members...);
  } catch (const std::exception& error) {
    throw std::runtime_error(path + ": " + error.what());
  }
}

void restore_estimator(const std::vector<std::uint8_t>& saved, std::shared_ptr<TrajectoryStore> rows,
                       ServedMap& map) {
  std::string toml;
  SnapshotReader reader(saved);
  reader(toml);
  const auto kind = feature_kind(parse_server_configuration(toml, "its configuration").estimator);
  if (kind)
    map.features = std::make_unique<FeatureEstimator>(FeatureEstimator::restore(*kind, saved));
  else
    map.engine = Engine::restore(saved, std::move(rows));
}

/// The rows of an engine's trajectory from one on, as they lie in memory (see TrajectoryStore).
std::vector<std::uint8_t> rows_from(const Engine& engine, std::uint64_t first) {
  const MapCopy map = engine.copy();
  std::vector<std::uint8_t> bytes;
  for (std::size_t at = first; at < map.trajectory_rows; at += rows_at_once) {
    const auto rows = map.trajectory->read(at, std::min(rows_at_once, map.trajectory_rows - at));
    const auto* from = reinterpret_cast<const std::uint8_t*>(rows.data());
    bytes.insert(bytes.end(), from, from + rows.size() * sizeof(TrajectoryRow));
  }
  return bytes;
}

}  // namespace

std::optional<FeatureMapKind> feature_kind(EstimatorKind estimator) {
  if (estimator == EstimatorKind::segments) return FeatureMapKind::segments;
  if (estimator == EstimatorKind::points) return FeatureMapKind::points;
  return std::nullopt;
}

void ServedMap::choose_estimator(const std::string& toml) {
  if (const auto kind = feature_kind(parse_server_configuration(toml, "configuration").estimator))
    features = std::make_unique<FeatureEstimator>(feature_map_options(*kind));
}

Snapshot read_snapshot(const std::string& path) {
  Snapshot snapshot;
  const std::vector<std::uint8_t> bytes = read_checked_file(path, snapshot_form).bytes;
  const std::string directory = fs::path(path).parent_path().string();
  Content content;
  auto rows = std::make_shared<TrajectoryStore>();
  try {
    SnapshotReader reader(bytes);
    reader(content);
  } catch (const std::exception& error) {
    throw std::runtime_error(path + ": " + error.what());
  }
  for (const TrajectoryPart& part : content.trajectory)
    read_rows(trajectory_path(directory, part.segment), part,
              [&](const TrajectoryRow& row) { rows->append(row); });
  try {
    restore_estimator(content.estimator, rows, snapshot.map);
  } catch (const std::exception& error) {
    throw std::runtime_error(path + ": " + error.what());
  }
  snapshot.map.channels = channels_of(snapshot.map.estimator().configuration());
  snapshot.place = content.place;
  snapshot.map.monitor = std::move(content.monitor);
  snapshot.map.events = content.events;
  snapshot.map.last_utime = content.last_utime;
  snapshot.map.set_aside = std::move(content.set_aside);
  snapshot.trajectory = std::move(content.trajectory);
  return snapshot;
}

JournalPlace read_snapshot_place(const std::string& path) {
  JournalPlace place;
  read_head(path, place);
  return place;
}

SnapshotSummary read_snapshot_summary(const std::string& path) {
  Content content;
  read_head(path, content.place, content.trajectory, content.monitor, content.events, content.last_utime);
  SnapshotSummary summary{content.place, content.events, content.last_utime, {}};
  if (content.trajectory.empty()) return summary;
  const TrajectoryPart& newest = content.trajectory.back();
  read_rows(trajectory_path(fs::path(path).parent_path().string(), newest.segment), newest,
            [&](const TrajectoryRow& row) {
              std::int64_t& newest_utime =
                  summary.scan_utime.try_emplace(row.session, row.utime).first->second;
              newest_utime = std::max(newest_utime, row.utime);
            });
  return summary;
}

void write_snapshot(const std::string& directory, const JournalPlace& place, ServedMap& map,
                    const std::vector<TrajectoryPart>& earlier) {
  Content content;
  content.place = place;
  content.trajectory = earlier;
  const std::uint64_t written =
      std::accumulate(earlier.begin(), earlier.end(), std::uint64_t{0},
                      [](std::uint64_t sum, const TrajectoryPart& part) { return sum + part.rows; });
  const std::vector<std::uint8_t> rows = rows_from(map.engine, written);
  if (!rows.empty()) {
    const Digest sha256 =
        write_checked_file(trajectory_path(directory, place.segment), trajectory_form, rows);
    content.trajectory.push_back({place.segment, rows.size() / sizeof(TrajectoryRow), sha256});
  }
  content.monitor = map.monitor;
  content.events = map.events;
  content.last_utime = map.last_utime;
  content.set_aside = map.set_aside;
  content.estimator = map.features ? map.features->save() : map.engine.save();
  SnapshotWriter writer;
  writer(content);
  write_checked_file(snapshot_path(directory, place.segment), snapshot_form, writer.take());
}

bool is_snapshot(const std::string& path) {
  std::error_code error;
  return fs::is_regular_file(path, error) && is_of_kind(path, snapshot_form);
}

}  // namespace isthmus
