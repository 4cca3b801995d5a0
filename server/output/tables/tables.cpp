#include "server/output/tables/tables.hpp"

#include <limits>

#include "relations/confidence.hpp"
#include "relations/mount_survey.hpp"
#include "server/engine/map/dependencies.hpp"
#include "server/output/format/csv.hpp"
#include "server/output/tables/trajectories.hpp"

namespace isthmus {
namespace {

constexpr double nan = std::numeric_limits<double>::quiet_NaN();

/// Of `members`, patches or tags by island: by patch id, relative to the first patch of each island.
std::vector<Eigen::Matrix3d> covariances(const MapCopy& map, const RankedIslands& islands,
                                         const std::vector<std::vector<PatchId>>& members) {
  std::vector<Eigen::Matrix3d> all(map.patches.size(), Eigen::Matrix3d::Constant(nan));
  for (std::size_t k = 0; k < members.size(); ++k) {
    if (members[k].empty()) continue;
    const PatchId first = islands.patches[k].front();
    const auto relative = exact_relative_covariances(map.graph, map.poses, first, members[k]);
    for (std::size_t i = 0; i < relative.size(); ++i) all[index(members[k][i])] = relative[i];
  }
  return all;
}

}  // namespace

void write_robots(const MapCopy& map, const RankedIslands& islands, const std::string& path) {
  CsvFile csv(path, "robot,island,from_s,to_s");
  for (const std::string& robot : robots_as_they_came(map)) {
    for (const Session& session : map.sessions) {
      if (session.robot != robot) continue;
      csv.row(robot, islands.rank(session.first_patch), seconds(session.from_utime),
              seconds(session.to_utime));
    }
  }
  csv.commit();
}

void write_patches(const MapCopy& map, const RankedIslands& islands, const std::string& path) {
  const std::vector<Eigen::Matrix3d> covariance = covariances(map, islands, islands.patches);
  CsvFile csv(path,
              "id,robot,utime_us,island,x_m,y_m,yaw_rad,cov_x_x,cov_x_y,cov_x_yaw,cov_y_y,cov_y_yaw,"
              "cov_yaw_yaw,free_space");
  for (std::size_t i = 0; i < map.patches.size(); ++i) {
    const Patch& patch = *map.patches[i];
    if (patch.tag >= 0 || islands.rank(patch.id) < 0) continue;
    const Pose& pose = map.poses[i];
    const PatchId first = islands.patches[static_cast<std::size_t>(islands.rank(patch.id))].front();
    const Eigen::Matrix3d c = covariance[i] + mount_covariance(ominus(pose, map.poses[index(first)]),
                                                               map.patches[index(first)]->robot, patch.robot);
    csv.row(patch.id, patch.robot, patch.utime, islands.rank(patch.id), pose.x, pose.y, pose.yaw, c(0, 0),
            c(0, 1), c(0, 2), c(1, 1), c(1, 2), c(2, 2), to_wkt(transformed(pose, patch.free_space)));
  }
  csv.commit();
}

void write_relations(const MapCopy& map, const std::string& path) {
  const Dependencies dependencies(map.graph);
  CsvFile csv(path, "id,a,b,kind,count,origin,closure,depends_on");
  for (const auto& [id, relation] : map.graph.relations()) {
    std::string depends_on;
    for (const ClosureId closure : dependencies.of(id))
      depends_on += (depends_on.empty() ? "" : " ") + std::to_string(closure.value);
    csv.row(id, relation.a, relation.b, name(relation.kind), count(relation), name(relation.origin.kind),
            relation.origin.closure, depends_on);
  }
  csv.commit();
}

void write_sightings(const MapCopy& map, const std::string& path) {
  CsvFile csv(path,
              "utime_us,observer,barcode,range_m,bearing_rad,range_std_m,bearing_std_rad,verdict,reason,"
              "closure");
  for (const auto& [sighting, verdict, reason, closure] : map.sightings) {
    csv.row(sighting.utime, sighting.robot, sighting.barcode, sighting.range_m, sighting.bearing_rad,
            sighting.range_sigma_m, sighting.bearing_sigma_rad, word(verdict), word(reason), closure);
  }
  csv.commit();
}

void write_finds(const MapCopy& map, const std::string& path) {
  CsvFile csv(
      path,
      "utime_us,robot,query,anchor,x_m,y_m,yaw_rad,way_m,search_score,carrier_score,seen_again,look_alikes,"
      "log_odds,waits");
  for (const FindRecord& find : map.finds) {
    const Pose& pose = find.anchor_from_query;
    csv.row(map.patches[static_cast<std::size_t>(find.query.value)]->utime, find.robot, find.query,
            find.anchor, pose.x, pose.y, pose.yaw, find.way_m, find.search_score, find.carrier_score,
            find.seen_again, find.look_alikes, find.log_odds, find.waits ? 1 : 0);
  }
  csv.commit();
}

void write_tags(const MapCopy& map, const RankedIslands& islands, const std::string& path) {
  const std::vector<Eigen::Matrix3d> covariance = covariances(map, islands, islands.tags);
  CsvFile csv(path, "barcode,island,x_m,y_m,cov_x_x,cov_x_y,cov_y_y,patch");
  for (const TagRecord& tag : map.tags) {
    const int k = islands.rank(tag.patch);
    if (k < 0) {
      csv.row(tag.barcode, -1, nan, nan, nan, nan, nan, tag.patch);
      continue;
    }
    const Eigen::Matrix3d& c = covariance[static_cast<std::size_t>(tag.patch.value)];
    csv.row(tag.barcode, k, tag.position.x(), tag.position.y(), c(0, 0), c(0, 1), c(1, 1), tag.patch);
  }
  csv.commit();
}

}  // namespace isthmus
