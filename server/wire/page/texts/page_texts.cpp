#include "server/wire/page/texts/page_texts.hpp"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <set>

#include "server/output/tables/islands.hpp"
#include "server/output/tables/trajectories.hpp"

namespace isthmus {
namespace {

using Json = nlohmann::json;

constexpr std::size_t max_closures = 1000;
constexpr std::size_t max_sightings = 60;

std::string line(const Json& json) { return json.dump(-1, ' ', false, Json::error_handler_t::replace); }

/// To the millimetre and the milliradian; what is no number is no place.
double to_millimetres(double value) { return std::isfinite(value) ? std::round(value * 1e3) / 1e3 : 0; }

Json pose_json(IslandId island, const Pose& pose) {
  return Json::array(
      {island.value, to_millimetres(pose.x), to_millimetres(pose.y), to_millimetres(pose.yaw)});
}

Json pose_json(const ShownMap& shown, const ManifoldPose& pose) {
  return pose_json(shown.island(pose.patch), shown.project(pose));
}

double as_seconds(std::int64_t utime) { return 1e-6 * static_cast<double>(utime); }

Json counts_json(const std::vector<count_t>& counts) {
  Json json = Json::object();
  for (const count_t& count : counts) json[count.reason] = count.count;
  return json;
}

/// From where to where it saw something; null where the observer's place is not known.
Json ray_json(const Trails& trails, const ShownMap& shown, const SightingEvent& sighting) {
  const std::optional<ManifoldPose> at = trails.at(sighting.robot, sighting.utime);
  if (!at || !shown.has(at->patch) || !std::isfinite(sighting.range_m)) return nullptr;
  const Pose from = shown.project(*at);
  const double bearing = from.yaw + sighting.bearing_rad;
  return Json::array({shown.island(at->patch).value, to_millimetres(from.x), to_millimetres(from.y),
                      to_millimetres(from.x + sighting.range_m * std::cos(bearing)),
                      to_millimetres(from.y + sighting.range_m * std::sin(bearing))});
}

Json robot_json(const robot_status_t& robot) {
  return {{"name", robot.robot},
          {"heard", as_seconds(robot.last_heard_utime)},
          {"message_hz", to_millimetres(robot.message_rate_hz)},
          {"scan_hz", to_millimetres(robot.scan_rate_hz)},
          {"scans", robot.scans},
          {"matched", to_millimetres(robot.share_matched)},
          {"dropped", counts_json(robot.dropped)}};
}

/// Those on the map, heard since the start or not.
Json robots_json(const ShownMap& shown) {
  std::map<std::string, robot_status_t> robots;
  for (const HealthRecord& known : shown.map().health) {
    robots[known.robot] = {};
    robots[known.robot].robot = known.robot;
  }
  for (const robot_status_t& heard : shown.view.status.robots)
    if (heard.last_heard_utime > 0) robots[heard.robot] = heard;
  Json json = Json::array();
  for (const auto& [name, robot] : robots) json.push_back(robot_json(robot));
  return json;
}

/// In the order in which they came to the map, and then those that are heard only, by name: a robot that
/// joins changes no other's place.
Json colours_json(const ShownMap& shown) {
  std::vector<std::string> robots = robots_as_they_came(shown.map());
  std::set<std::string> others;
  for (const HealthRecord& known : shown.map().health) others.insert(known.robot);
  for (const robot_status_t& heard : shown.view.status.robots) others.insert(heard.robot);
  for (const std::string& robot : robots) others.erase(robot);
  robots.insert(robots.end(), others.begin(), others.end());
  return robots;
}

Json warnings_json(const status_t& status) {
  Json warnings = Json::array();
  for (const warning_t& warning : status.warnings) {
    warnings.push_back({{"kind", warning.kind},
                        {"robot", warning.robot},
                        {"text", warning.text},
                        {"since", as_seconds(warning.begin_utime)}});
  }
  return warnings;
}

Json box_json(const MapBox& box) {
  return Json::array({to_millimetres(box.low.x()), to_millimetres(box.low.y()), to_millimetres(box.high.x()),
                      to_millimetres(box.high.y())});
}

/// What a closure has on the map.
struct ClosureRelations {
  int count = 0;
  RelationId first;
};

std::map<ClosureId, ClosureRelations> relations_of_closures(const MapCopy& map) {
  std::map<ClosureId, ClosureRelations> all;
  for (const auto& [id, relation] : map.graph.relations()) {
    if (!relation.origin.closure.valid()) continue;
    ClosureRelations& of = all[relation.origin.closure];
    if (++of.count == 1) of.first = id;
  }
  return all;
}

/// From where to where a closure holds the map together; null where it has nothing on it.
Json line_json(const ShownMap& shown, const ClosureRelations& relations) {
  if (relations.count == 0) return nullptr;
  const Relation& relation = *shown.map().graph.find(relations.first);
  const Pose& a = shown.map().poses[static_cast<std::size_t>(relation.a.value)];
  const Pose& b = shown.map().poses[static_cast<std::size_t>(relation.b.value)];
  return {shown.island(relation.a).value, to_millimetres(a.x), to_millimetres(a.y), to_millimetres(b.x),
          to_millimetres(b.y)};
}

/// Of its last trial; null where it has had none.
Json trial_json(const TrialAccount& trial) {
  if (trial.supporters == 0 && trial.compared == 0) return nullptr;
  return {{"supporters", trial.supporters},
          {"compared", trial.compared},
          {"matched", trial.matched},
          {"contradiction", to_millimetres(trial.contradiction)},
          {"own_contradiction", to_millimetres(trial.own_contradiction)},
          {"log_odds", to_millimetres(trial.log_odds())}};
}

Json closure_json(const ShownMap& shown, const ClosureRecord& closure, const ClosureRelations& relations) {
  return {{"id", closure.id.value},
          {"kind", std::string(word(closure.kind))},
          {"state", std::string(word(closure.state))},
          {"reason", std::string(word(closure.reason))},
          {"forbidden", std::ranges::binary_search(shown.map().forbidden, closure.id)},
          {"robots", closure.robots},
          {"patches", closure.patches_touched},
          {"steps", closure.work_steps},
          {"relations", relations.count},
          {"line", line_json(shown, relations)},
          {"trial", trial_json(closure.account)},
          {"start", as_seconds(closure.start_utime)},
          {"end", as_seconds(closure.end_utime)}};
}

}  // namespace

std::string robots_text(const Trails& trails, const ShownMap& shown) {
  Json robots = Json::array();
  for (const auto& [name, robot] : trails.robots()) {
    const RobotPose& newest = robot.newest;
    // A patch of the newest pose may be newer than the map that is shown.
    const bool is_shown = shown.has(newest.pose.patch);
    robots.push_back(
        {{"name", name},
         {"time", as_seconds(newest.utime)},
         {"matched", newest.matched},
         {"heard", robot.heard},
         {"at", is_shown ? pose_json(shown, newest.pose) : pose_json(newest.island, newest.map_from_robot)}});
  }
  return line(robots);
}

std::string trails_text(const Trails& trails, const ShownMap& shown) {
  Json all = Json::object();
  for (const auto& [name, robot] : trails.robots()) {
    Json& steps = all[name] = Json::array();
    for (const ManifoldPose& pose : robot.trail) {
      if (!shown.has(pose.patch)) continue;
      const Pose at = shown.project(pose);
      steps.push_back(
          Json::array({shown.island(pose.patch).value, to_millimetres(at.x), to_millimetres(at.y)}));
    }
  }
  return line(all);
}

std::string islands_text(const ShownMap& shown, const std::map<IslandId, TileStore::Extent>& tiles) {
  std::map<IslandId, int> patches;
  std::map<IslandId, std::int32_t> newest;
  for (std::size_t i = 0; i < shown.island_of.size(); ++i) {
    patches[shown.island_of[i]] += 1;
    std::int32_t& end = newest[shown.island_of[i]];
    end = std::max(end, tenths_of_patch(shown, i));
  }
  const RankedIslands ranked = rank_islands(shown.map());
  Json islands = Json::array();
  for (const auto& [island, extent] : tiles) {
    const auto version = shown.version.find(island);
    if (version == shown.version.end()) continue;
    islands.push_back({{"id", island.value},
                       {"tiles", extent.version},
                       {"map", version->second},
                       {"patches", patches[island]},
                       {"rank", ranked.rank(island)},
                       {"end", newest[island]},
                       {"box", box_json(extent.box)}});
  }
  return line(islands);
}

std::string tags_text(const ShownMap& shown) {
  Json tags = Json::array();
  for (const TagRecord& tag : shown.map().tags) {
    if (!tag.placed) continue;
    tags.push_back(
        {{"barcode", tag.barcode}, {"at", pose_json(tag.island, {tag.position.x(), tag.position.y(), 0})}});
  }
  return line(tags);
}

std::string annotations_text(const ShownMap& shown) {
  Json annotations = Json::array();
  for (const AnnotationRecord& annotation : shown.map().annotations) {
    Json points = Json::array();
    for (const ManifoldPose& point : annotation.points) {
      if (annotation.lost || !shown.has(point.patch)) continue;
      const Pose at = shown.project(point);
      points.push_back(Json::array({to_millimetres(at.x), to_millimetres(at.y), to_millimetres(at.yaw)}));
    }
    annotations.push_back({{"kind", std::string(word(annotation.kind))},
                           {"name", annotation.name},
                           {"max_speed", annotation.max_speed_m_s},
                           {"island", annotation.island.value},
                           {"moved", annotation.moved},
                           {"lost", annotation.lost},
                           {"points", std::move(points)}});
  }
  return line(annotations);
}

std::string closures_text(const ShownMap& shown) {
  const MapCopy& map = shown.map();
  std::map<ClosureId, ClosureRelations> relations = relations_of_closures(map);
  Json closures = Json::array();
  for (auto closure = map.closures.rbegin(); closure != map.closures.rend(); ++closure) {
    if (closures.size() >= max_closures) break;
    closures.push_back(closure_json(shown, *closure, relations[closure->id]));
  }
  return line(closures);
}

std::string sightings_text(const Trails& trails, const ShownMap& shown) {
  const SightingLog& log = shown.map().sightings;
  Json sightings = Json::array();
  for (std::size_t i = log.size(); i > 0 && sightings.size() < max_sightings; --i) {
    const SightingRecord record = log[i - 1];
    sightings.push_back(
        {{"number", i - 1},
         {"time", as_seconds(shown.clocks.server_utime(record.sighting.robot, record.sighting.utime))},
         {"robot", record.sighting.robot},
         {"barcode", record.sighting.barcode},
         {"verdict", std::string(word(record.verdict))},
         {"reason", std::string(word(record.reason))},
         {"closure", record.closure.value},
         {"ray", ray_json(trails, shown, record.sighting)}});
  }
  return line(sightings);
}

std::string status_text(const ShownMap& shown) {
  const status_t& status = shown.view.status;
  return line({{"time", as_seconds(status.utime)},
               {"events", status.events},
               {"scans", status.scans},
               {"scans_matched", status.scans_matched},
               {"patches", status.patches},
               {"relations", status.relations},
               {"sightings",
                {{"accepted", status.sightings_accepted},
                 {"refused", status.sightings_refused},
                 {"waiting", status.sightings_waiting}}},
               {"queued", status.queued},
               {"journal_bytes", status.journal_bytes},
               {"journal_waiting", status.journal_waiting},
               {"dropped", counts_json(status.dropped)},
               {"latency_p99_ms", to_millimetres(1e3 * shown.view.latency_p99_s)},
               {"frozen", shown.view.frozen},
               {"robots", robots_json(shown)},
               {"colours", colours_json(shown)},
               {"left_out", left_out_robots(shown.map())},
               {"warnings", warnings_json(status)}});
}

std::string meeting_text(const ShownMap& shown) {
  const std::optional<MeetingRecord>& meeting = shown.map().meeting;
  if (!meeting || !shown.has(meeting->a.pose.patch) || !shown.has(meeting->b.pose.patch)) return "null";
  const auto place = [&](const MeetingPlace& of) -> Json {
    return {{"robot", of.robot}, {"at", pose_json(shown, of.pose)}};
  };
  return line({{"closure", meeting->closure.value}, {"places", {place(meeting->a), place(meeting->b)}}});
}

}  // namespace isthmus
