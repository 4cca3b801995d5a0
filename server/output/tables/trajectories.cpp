#include "server/output/tables/trajectories.hpp"

#include <algorithm>
#include <map>
#include <set>

#include "server/output/format/atomic_file.hpp"
#include "server/output/format/tum.hpp"

namespace isthmus {
namespace {

constexpr std::size_t rows_at_a_time = 4096;

bool is_parted(const RelationGraph& graph, const Session& session, PatchId patch) {
  return !session.first_patch.valid() || graph.island(session.first_patch) != graph.island(patch);
}

}  // namespace

void for_each_row(const MapCopy& map, const std::function<void(const ProjectedRow&)>& visit) {
  if (!map.trajectory) return;
  for (std::size_t first = 0; first < map.trajectory_rows; first += rows_at_a_time) {
    const std::size_t count = std::min(rows_at_a_time, map.trajectory_rows - first);
    const std::vector<TrajectoryRow> rows = map.trajectory->read(first, count);
    for (const TrajectoryRow& row : rows) {
      const auto session = static_cast<std::size_t>(row.session);
      const auto patch = static_cast<std::size_t>(row.patch.value);
      if (session >= map.sessions.size() || patch >= map.poses.size()) continue;
      visit({map.sessions[session], row.utime, row.patch, map.poses[patch] * row.patch_from_robot,
             is_parted(map.graph, map.sessions[session], row.patch)});
    }
    if (rows.size() < count) throw std::runtime_error("the trajectories' temporary file cannot be read back");
  }
}

std::vector<std::string> robots_of(const MapCopy& map) {
  std::vector<std::string> robots;
  for (const Session& session : map.sessions) robots.push_back(session.robot);
  std::sort(robots.begin(), robots.end());
  robots.erase(std::unique(robots.begin(), robots.end()), robots.end());
  return robots;
}

std::vector<std::string> robots_as_they_came(const MapCopy& map) {
  std::vector<std::string> robots;
  std::set<std::string> known;
  for (const Session& session : map.sessions)
    if (known.insert(session.robot).second) robots.push_back(session.robot);
  return robots;
}

std::string file_name_of(const std::string& robot) {
  constexpr std::string_view hex = "0123456789ABCDEF";
  std::string name;
  for (const char c : robot) {
    const bool plain =
        (c >= 'A' && c <= 'Z') || (c >= 'a' && c <= 'z') || (c >= '0' && c <= '9') || c == '_' || c == '-';
    const auto byte = static_cast<unsigned char>(c);
    if (plain) {
      name += c;
    } else {
      name += {'%', hex[byte >> 4], hex[byte & 0xf]};
    }
  }
  return name;
}

std::size_t count_parted_rows(const MapCopy& map) {
  std::size_t parted = 0;
  for_each_row(map, [&](const ProjectedRow& row) { parted += row.parted ? 1U : 0U; });
  return parted;
}

void write_trajectories(const MapCopy& map, const std::string& directory) {
  std::map<std::string, AtomicFile> files;
  for (const std::string& robot : robots_of(map)) {
    files.try_emplace(robot, directory + "/" + file_name_of(robot) + ".tum");
  }
  for_each_row(map, [&](const ProjectedRow& row) {
    if (!row.parted) files.at(row.session.robot).write(tum_line(row.utime, row.map_from_robot));
  });
  for (auto& [robot, file] : files) file.commit();
}

}  // namespace isthmus
