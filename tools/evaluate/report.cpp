#include "tools/evaluate/report.hpp"

#include <nlohmann/json.hpp>

#include "tools/text/printed.hpp"

namespace isthmus {
namespace {

using Json = nlohmann::ordered_json;

std::string relation_text(const std::string& kind, const RelationErrors& errors) {
  std::string text =
      printed_line("%s: %zu relations, %zu missing", kind.c_str(), errors.count, errors.missing);
  if (errors.count == 0) return text;
  const auto row = [&](const char* what, const Statistics& s, const char* unit) {
    text += printed_line("  %-20s mean %9.4f ± %9.4f  median %9.4f  max %9.4f %s", what, s.mean, s.deviation,
                         s.median, s.max, unit);
  };
  row("translation", errors.translation_m, "m");
  row("rotation", errors.rotation_deg, "deg");
  row("squared translation", errors.squared_translation_m2, "m²");
  row("squared rotation", errors.squared_rotation_deg2, "deg²");
  return text;
}

std::string statistics_text(const std::string& name, const char* what, const Statistics& s, std::size_t count,
                            const char* unit) {
  return printed_line("  %-12s %-8s mean %8.4f ± %8.4f  median %8.4f  rmse %8.4f  max %8.4f %s (%zu)",
                      name.c_str(), what, s.mean, s.deviation, s.median, s.rms, s.max, unit, count);
}

std::string pose_text(const std::string& name, const PoseErrors& errors) {
  return statistics_text(name, "position", errors.translation_m, errors.count, "m") +
         statistics_text("", "heading", errors.rotation_deg, errors.count, "deg");
}

std::string absolute_text(const AbsoluteErrors& errors) {
  std::string text;
  for (const IslandErrors& island : errors.islands) {
    const Pose& motion = island.truth_from_map;
    text += printed_line("island %d, aligned as a whole by (%.3f m, %.3f m, %.4f rad)", island.island,
                         motion.x, motion.y, motion.yaw);
    for (const auto& [robot, own] : island.robots) text += pose_text(robot, own);
    if (island.robots.size() > 1) text += pose_text("all robots", island.team);
    if (island.tags > 0)
      text += statistics_text("tags", "position", island.tag_translation_m, island.tags, "m");
  }
  for (const auto& [robot, count] : errors.missing) {
    if (count > 0) text += printed_line("%s: %zu stamps of the truth without a pose", robot.c_str(), count);
  }
  if (errors.missing_tags > 0) text += printed_line("%zu true tags without a place", errors.missing_tags);
  return text;
}

std::string pose_graph_text(const PoseGraphFit& fit) {
  return printed_line("%zu patches, %zu relations, %zu islands", fit.patches, fit.relations, fit.islands) +
         printed_line("F %.6g before, %.8g after %d iterations, %.1f ms CPU%s", fit.f_before, fit.f_after,
                      fit.iterations, 1e3 * fit.cpu_s, fit.failure.empty() ? "" : ": NO SOLUTION");
}

Json json(const Statistics& s) {
  return {{"mean", s.mean}, {"std", s.deviation}, {"median", s.median}, {"max", s.max}, {"rms", s.rms}};
}

Json json(const RelationErrors& errors) {
  if (errors.count == 0) return {{"count", 0}, {"missing", errors.missing}};
  return {{"count", errors.count},
          {"missing", errors.missing},
          {"translation_m", json(errors.translation_m)},
          {"rotation_deg", json(errors.rotation_deg)},
          {"squared_translation_m2", json(errors.squared_translation_m2)},
          {"squared_rotation_deg2", json(errors.squared_rotation_deg2)}};
}

Json pose_json(const PoseErrors& errors) {
  return {{"count", errors.count},
          {"rms_m", errors.translation_m.rms},
          {"translation_m", json(errors.translation_m)},
          {"rotation_deg", json(errors.rotation_deg)}};
}

/// A flat list of robots, and one of islands.
void add_absolute(const AbsoluteErrors& errors, Json& all) {
  Json robots = Json::array();
  Json islands = Json::array();
  for (const IslandErrors& island : errors.islands) {
    for (const auto& [robot, own] : island.robots) {
      Json entry = {{"robot", robot}, {"island", island.island}};
      entry.update(pose_json(own));
      robots.push_back(std::move(entry));
    }
    const Pose& motion = island.truth_from_map;
    Json entry = {{"island", island.island}, {"truth_from_map", {motion.x, motion.y, motion.yaw}}};
    entry.update(pose_json(island.team));
    entry["tags"] = island.tags;
    if (island.tags > 0) entry["tag_translation_m"] = json(island.tag_translation_m);
    islands.push_back(std::move(entry));
  }
  all["absolute"] = std::move(robots);
  all["absolute_islands"] = std::move(islands);
  all["missing"] = errors.missing;
  all["missing_tags"] = errors.missing_tags;
}

Json json(const PoseGraphFit& fit) {
  return {{"patches", fit.patches},    {"relations", fit.relations}, {"islands", fit.islands},
          {"f_before", fit.f_before},  {"f_after", fit.f_after},     {"iterations", fit.iterations},
          {"cpu_ms", 1e3 * fit.cpu_s}, {"ok", fit.failure.empty()}};
}

std::string landmarks_text(const LandmarkEvaluation& all) {
  std::string text = printed_line("%zu poses, %zu landmarks, %zu sightings; errors against the %s", all.poses,
                                  all.landmarks, all.sightings, all.against_batch ? "batch fit" : "truth");
  text += printed_line("%-10s %9s %9s %8s %9s %9s %9s %9s %7s %8s", "", "pose m", "pose deg", "NEES/3",
                       "landm. m", "aligned m", "landmarks", "features", "wrong", "CPU s");
  for (const LandmarkEvaluation::Row& row : all.rows) {
    const LandmarkErrors& e = row.errors;
    text += printed_line("%-10s %9.3f %9.3f %8.3f %9.3f %9.3f %9zu %9zu %7zu %8.2f%s", row.name.c_str(),
                         e.pose_rmse_m, e.pose_rmse_deg, e.nees_per_dof, e.landmark_rmse_m,
                         e.landmark_aligned_m, e.landmarks, row.map.features, row.map.wrong_pairs,
                         row.map.cpu_s, row.map.failure.empty() ? "" : " NO SOLUTION");
    if (row.map.chi_squared_per_dof > 0)
      text += printed_line("%-10s chi²/dof %.3f", "", row.map.chi_squared_per_dof);
  }
  for (const LandmarkEvaluation::FreshNoise& mean : all.fresh)
    text += printed_line("%-10s %9.3f %9.3f %8.3f over %zu fresh noises", mean.name.c_str(), mean.pose_rmse_m,
                         mean.pose_rmse_deg, mean.nees_per_dof, all.noises);
  return text;
}

Json json(const LandmarkEvaluation& all) {
  Json rows = Json::array();
  for (const LandmarkEvaluation::Row& row : all.rows)
    rows.push_back({{"estimator", row.name},
                    {"pose_rmse_m", row.errors.pose_rmse_m},
                    {"pose_rmse_deg", row.errors.pose_rmse_deg},
                    {"nees_per_dof", row.errors.nees_per_dof},
                    {"landmark_rmse_m", row.errors.landmark_rmse_m},
                    {"landmark_aligned_m", row.errors.landmark_aligned_m},
                    {"landmarks", row.errors.landmarks},
                    {"features", row.map.features},
                    {"wrong_pairs", row.map.wrong_pairs},
                    {"chi_squared_per_dof", row.map.chi_squared_per_dof},
                    {"cpu_s", row.map.cpu_s},
                    {"ok", row.map.failure.empty()}});
  Json fresh = Json::array();
  for (const LandmarkEvaluation::FreshNoise& mean : all.fresh)
    fresh.push_back({{"estimator", mean.name},
                     {"pose_rmse_m", mean.pose_rmse_m},
                     {"pose_rmse_deg", mean.pose_rmse_deg},
                     {"nees_per_dof", mean.nees_per_dof},
                     {"runs", all.noises}});
  return {{"poses", all.poses}, {"landmarks", all.landmarks},         {"sightings", all.sightings},
          {"estimators", rows}, {"against_batch", all.against_batch}, {"fresh_noises", fresh}};
}

}  // namespace

std::string to_text(const Evaluation& evaluation) {
  std::string text;
  for (const auto& [kind, errors] : evaluation.relations) text += relation_text(kind, errors);
  if (evaluation.absolute) text += absolute_text(*evaluation.absolute);
  if (evaluation.pose_graph) text += pose_graph_text(*evaluation.pose_graph);
  if (evaluation.landmarks) text += landmarks_text(*evaluation.landmarks);
  return text;
}

std::string to_json(const Evaluation& evaluation) {
  Json relations = Json::object();
  for (const auto& [kind, errors] : evaluation.relations) relations[kind] = json(errors);
  Json all = {{"relations", relations}, {"absolute", Json::array()}};
  if (evaluation.absolute) add_absolute(*evaluation.absolute, all);
  if (evaluation.pose_graph) all["pose_graph"] = json(*evaluation.pose_graph);
  if (evaluation.landmarks) all["landmarks"] = json(*evaluation.landmarks);
  return all.dump(2) + "\n";
}

}  // namespace isthmus
