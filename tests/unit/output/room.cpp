#include "tests/unit/output/room.hpp"

#include <cmath>
#include <cstdlib>
#include <fstream>
#include <limits>
#include <numbers>
#include <sstream>

#include "server/engine/sightings/evidence.hpp"

namespace isthmus::testing {
namespace {

/// Distance along the ray to the wall; +infinity where it misses.
double distance_m(const Eigen::Vector2d& origin, const Eigen::Vector2d& direction, const Wall& wall) {
  const Eigen::Vector2d along = wall.to - wall.from;
  const double determinant = direction.x() * -along.y() + direction.y() * along.x();
  if (std::abs(determinant) < 1e-12) return std::numeric_limits<double>::infinity();
  const Eigen::Vector2d offset = wall.from - origin;
  const double range = (offset.x() * -along.y() + offset.y() * along.x()) / determinant;
  const double share = (direction.x() * offset.y() - direction.y() * offset.x()) / determinant;
  return range > 0 && share >= 0 && share <= 1 ? range : std::numeric_limits<double>::infinity();
}

}  // namespace

std::vector<Wall> rectangle(double left, double bottom, double right, double top) {
  return {{{left, bottom}, {right, bottom}},
          {{right, bottom}, {right, top}},
          {{right, top}, {left, top}},
          {{left, top}, {left, bottom}}};
}

Scan scan_at(const std::vector<Wall>& walls, const Pose& map_from_robot, std::int64_t utime,
             std::size_t beams, double range_max_m) {
  Scan scan{utime, -std::numbers::pi, 2 * std::numbers::pi / static_cast<double>(beams), {}};
  for (std::size_t beam = 0; beam < beams; ++beam) {
    const double bearing = scan.bearing0_rad + static_cast<double>(beam) * scan.bearing_step_rad;
    const Eigen::Vector2d direction = rotate(map_from_robot.yaw + bearing, Eigen::Vector2d::UnitX());
    double range_m = std::numeric_limits<double>::infinity();
    for (const Wall& wall : walls) {
      range_m = std::min(range_m, distance_m({map_from_robot.x, map_from_robot.y}, direction, wall));
    }
    if (range_m >= range_max_m) range_m = std::numeric_limits<double>::infinity();
    scan.ranges_m.push_back(static_cast<float>(range_m));
  }
  return scan;
}

MapCopy map_of(const std::vector<Wall>& walls, const std::vector<Pose>& map_from_patches,
               const PatchOptions& options) {
  MapCopy map;
  auto trajectory = std::make_shared<TrajectoryStore>();
  map.poses = map_from_patches;
  for (std::size_t i = 0; i < map_from_patches.size(); ++i) {
    const PatchId id{static_cast<std::int32_t>(i)};
    const std::int64_t utime = 1'000'000 * (static_cast<std::int64_t>(i) + 1);
    map.patches.push_back(make_patch(id, "R1", scan_at(walls, map_from_patches[i], utime), Laser{}, options));
    map.graph.add_patch(id);
    if (i > 0) {
      map.graph.add(relative_pose(PatchId{id.value - 1}, id,
                                  ominus(map_from_patches[i], map_from_patches[i - 1]),
                                  Eigen::Vector3d(400, 400, 1600).asDiagonal()));
    }
    trajectory->append({utime, 0, id, Pose{}});
  }
  trajectory->flush();
  if (!map.patches.empty()) {
    map.sessions = {{"R1", 0, map.patches.front()->utime, map.patches.back()->utime, PatchId{0}}};
  }
  map.trajectory_rows = trajectory->size();
  map.trajectory = trajectory;
  return map;
}

MapCopy room() { return map_of(rectangle(0.025, 0.025, 4.025, 3.025), {{1, 1, 0}, {2, 1, 0.2}, {3, 2, 1}}); }

Relation relative_pose(PatchId a, PatchId b, const Pose& a_from_b, const Eigen::Matrix3d& information) {
  Relation relation;
  relation.a = a;
  relation.b = b;
  relation.kind = RelationKind::odometry;
  relation.measurement = RelativePose{a_from_b, information};
  relation.origin.kind = OriginKind::odometry;
  return relation;
}

PatchId add_tag(MapCopy& map, std::int32_t barcode, PatchId seen_from, const Eigen::Vector2d& position) {
  const PatchId id{static_cast<std::int32_t>(map.patches.size())};
  map.patches.push_back(make_tag_patch(id, barcode, 1'000'000));
  map.poses.push_back({position.x(), position.y(), 0});
  map.graph.add_patch(id);
  if (seen_from.valid()) {
    const Pose& map_from_observer = map.poses[static_cast<std::size_t>(seen_from.value)];
    map.graph.add(relative_pose(seen_from, id, ominus(map.poses.back(), map_from_observer),
                                Eigen::Vector3d(100, 25, 1e-4).asDiagonal()));
  }
  map.tags.push_back({barcode, map.graph.island(id), position, Eigen::Matrix2d::Zero(), true, id});
  return id;
}

TemporaryDirectory::TemporaryDirectory() {
  std::string name = (std::filesystem::temp_directory_path() / "isthmus-output-test-XXXXXX").string();
  if (::mkdtemp(name.data()) == nullptr) throw std::runtime_error("no temporary directory");
  path_ = name;
}

TemporaryDirectory::~TemporaryDirectory() {
  std::error_code ignored;
  std::filesystem::remove_all(path_, ignored);
}

std::string content(const std::string& file) {
  std::ifstream stream(file, std::ios::binary);
  if (!stream) throw std::runtime_error(file + " is not there");
  std::ostringstream bytes;
  bytes << stream.rdbuf();
  return bytes.str();
}

std::vector<std::string> lines(const std::string& file) {
  std::istringstream stream(content(file));
  std::vector<std::string> all;
  for (std::string line; std::getline(stream, line);) all.push_back(line);
  return all;
}

}  // namespace isthmus::testing
