#include "tools/evaluate/trajectories.hpp"

#include <algorithm>
#include <cmath>
#include <filesystem>

#include "server/engine/input/robot_name.hpp"
#include "tools/text/csv.hpp"
#include "tools/text/lines.hpp"
#include "tools/text/numbers.hpp"

namespace isthmus {
namespace {

constexpr std::int64_t nearest_within_us = 100'000;
/// Stamps may run back by as much, so a scan may lie outside its session.
constexpr std::int64_t session_within_us = 1'000'000;

double yaw_of_quaternion(double x, double y, double z, double w) {
  return std::atan2(2 * (w * z + x * y), w * w + x * x - y * y - z * z);
}

std::optional<StampedPose> parse_tum_row(const std::vector<std::string_view>& words) {
  if (words.size() != 8) return std::nullopt;
  const auto utime = parse_seconds_as_us(words[0]);
  if (!utime) return std::nullopt;
  double values[7];
  for (std::size_t i = 0; i < 7; ++i) {
    const auto value = parse_double(words[i + 1]);
    if (!value || !std::isfinite(*value)) return std::nullopt;
    values[i] = *value;
  }
  const double yaw = yaw_of_quaternion(values[3], values[4], values[5], values[6]);
  return StampedPose{*utime, {values[0], values[1], yaw}};
}

}  // namespace

Trajectory::Trajectory(std::vector<StampedPose> rows) : rows_(std::move(rows)) {
  std::stable_sort(rows_.begin(), rows_.end(),
                   [](const StampedPose& a, const StampedPose& b) { return a.utime < b.utime; });
}

std::optional<StampedPose> Trajectory::nearest(std::int64_t utime, std::int64_t within_us) const {
  const auto by_utime = [](const StampedPose& row, std::int64_t t) { return row.utime < t; };
  const auto after = std::lower_bound(rows_.begin(), rows_.end(), utime, by_utime);
  auto best = after;
  if (after != rows_.begin()) {
    const std::int64_t before_utime = std::prev(after)->utime;
    if (after == rows_.end() || utime - before_utime <= after->utime - utime) {
      best = std::lower_bound(rows_.begin(), rows_.end(), before_utime, by_utime);
    }
  }
  if (best == rows_.end() || std::abs(best->utime - utime) > within_us) return std::nullopt;
  return *best;
}

Trajectory read_tum(const std::string& file) {
  LineReader lines(file);
  std::vector<StampedPose> rows;
  std::vector<std::string_view> words;
  while (const auto line = lines.next()) {
    split_words(*line, words);
    if (words.empty() || words[0][0] == '#') continue;
    const auto row = parse_tum_row(words);
    if (!row) throw FileError(file, lines.number(), "expected 'timestamp tx ty tz qx qy qz qw'");
    rows.push_back(*row);
  }
  return Trajectory(std::move(rows));
}

std::map<std::string, Trajectory> read_trajectories(const std::string& directory) {
  std::map<std::string, Trajectory> trajectories;
  std::error_code error;
  std::filesystem::directory_iterator entry(directory, error);
  for (const std::filesystem::directory_iterator end; !error && entry != end; entry.increment(error)) {
    if (entry->path().extension() != ".tum") continue;
    trajectories.emplace(upper_case(entry->path().stem().string()), read_tum(entry->path().string()));
  }
  if (error) throw FileError(directory, 0, error.message());
  if (trajectories.empty()) throw FileError(directory, 0, "no trajectories (*.tum)");
  return trajectories;
}

TeamTrajectories::TeamTrajectories(const std::string& directory)
    : trajectories_(read_trajectories(directory + "/trajectories")) {
  const std::string robots = directory + "/robots.csv";
  if (std::filesystem::exists(robots)) read_sessions(robots);
}

void TeamTrajectories::read_sessions(const std::string& file) {
  CsvReader csv(file);
  has_sessions_ = true;
  while (csv.next()) {
    const auto from = parse_seconds_as_us(csv.text("from_s"));
    const auto to = parse_seconds_as_us(csv.text("to_s"));
    if (!from || !to) csv.fail("from_s or to_s is not a time in seconds");
    const int island = csv.text("island").empty() ? -1 : static_cast<int>(csv.integer("island"));
    const std::string robot = upper_case(csv.text("robot"));
    if (!sessions_.contains(robot)) as_they_came_.push_back(robot);
    sessions_[robot].push_back({island, *from, *to});
  }
}

std::vector<std::string> TeamTrajectories::robots() const {
  std::vector<std::string> all = as_they_came_;
  for (const auto& [robot, trajectory] : trajectories_)
    if (!sessions_.contains(robot)) all.push_back(robot);
  return all;
}

std::optional<PlacedPose> TeamTrajectories::pose(const std::string& robot, std::int64_t utime) const {
  const auto trajectory = trajectories_.find(robot);
  if (trajectory == trajectories_.end()) return std::nullopt;
  const auto row = trajectory->second.nearest(utime, nearest_within_us);
  if (!row) return std::nullopt;
  if (!has_sessions_) return PlacedPose{0, row->utime, row->map_from_robot};
  const auto sessions = sessions_.find(robot);
  if (sessions == sessions_.end()) return std::nullopt;
  const Session* best = nullptr;
  std::int64_t nearest_us = session_within_us;
  for (const Session& session : sessions->second) {
    const std::int64_t outside_us =
        std::max<std::int64_t>({session.from_utime - row->utime, row->utime - session.to_utime, 0});
    if (session.island < 0 || outside_us > nearest_us) continue;
    best = &session;
    nearest_us = outside_us;
  }
  if (best != nullptr) return PlacedPose{best->island, row->utime, row->map_from_robot};
  return std::nullopt;
}

}  // namespace isthmus
