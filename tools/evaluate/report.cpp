#include "tools/evaluate/report.hpp"

#include <array>
#include <cstdio>
#include <nlohmann/json.hpp>

namespace isthmus {
namespace {

using Json = nlohmann::ordered_json;

template <class... Values>
std::string line(const char* format, Values... values) {
  std::array<char, 256> buffer{};
  std::snprintf(buffer.data(), buffer.size(), format, values...);
  return std::string(buffer.data()) + "\n";
}

std::string relation_text(const std::string& kind, const RelationErrors& errors) {
  std::string text = line("%s: %zu relations, %zu missing", kind.c_str(), errors.count, errors.missing);
  if (errors.count == 0) return text;
  const auto row = [&](const char* what, const Statistics& s, const char* unit) {
    text += line("  %-20s mean %9.4f ± %9.4f  median %9.4f  max %9.4f %s", what, s.mean, s.deviation,
                 s.median, s.max, unit);
  };
  row("translation", errors.translation_m, "m");
  row("rotation", errors.rotation_deg, "deg");
  row("squared translation", errors.squared_translation_m2, "m²");
  row("squared rotation", errors.squared_rotation_deg2, "deg²");
  return text;
}

std::string pose_graph_text(const PoseGraphFit& fit) {
  return line("%zu patches, %zu relations, %zu islands", fit.patches, fit.relations, fit.islands) +
         line("F %.6g before, %.8g after %d iterations, %.1f ms CPU%s", fit.f_before, fit.f_after,
              fit.iterations, 1e3 * fit.cpu_s, fit.ok ? "" : ": NO SOLUTION");
}

Json json(const Statistics& s) {
  return {{"mean", s.mean}, {"std", s.deviation}, {"median", s.median}, {"max", s.max}};
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

Json json(const AbsoluteErrors& errors) {
  return {{"robot", errors.robot},
          {"island", errors.island},
          {"count", errors.count},
          {"rms_m", errors.rms_m},
          {"translation_m", json(errors.translation_m)},
          {"rotation_deg", json(errors.rotation_deg)}};
}

Json json(const PoseGraphFit& fit) {
  return {{"patches", fit.patches},    {"relations", fit.relations},
          {"islands", fit.islands},    {"f_before", fit.f_before},
          {"f_after", fit.f_after},    {"iterations", fit.iterations},
          {"cpu_ms", 1e3 * fit.cpu_s}, {"ok", fit.ok}};
}

}  // namespace

std::string to_text(const Evaluation& evaluation) {
  std::string text;
  for (const auto& [kind, errors] : evaluation.relations) text += relation_text(kind, errors);
  for (const AbsoluteErrors& e : evaluation.absolute) {
    text += line(
        "%s on island %d, aligned: %zu poses, rms %.4f m, median %.4f m, max %.4f m, rotation mean %.3f deg",
        e.robot.c_str(), e.island, e.count, e.rms_m, e.translation_m.median, e.translation_m.max,
        e.rotation_deg.mean);
  }
  if (evaluation.pose_graph) text += pose_graph_text(*evaluation.pose_graph);
  return text;
}

std::string to_json(const Evaluation& evaluation) {
  Json relations = Json::object();
  for (const auto& [kind, errors] : evaluation.relations) relations[kind] = json(errors);
  Json absolute = Json::array();
  for (const AbsoluteErrors& errors : evaluation.absolute) absolute.push_back(json(errors));
  Json all = {{"relations", relations}, {"absolute", absolute}};
  if (evaluation.pose_graph) all["pose_graph"] = json(*evaluation.pose_graph);
  return all.dump(2) + "\n";
}

}  // namespace isthmus
