#include "server/wire/watch/live_warnings.hpp"

#include <algorithm>
#include <cstdio>
#include <tuple>

namespace isthmus {
namespace {

auto key_of(const LiveWarning& warning) { return std::tie(warning.kind, warning.robot); }

LogFields fields_of(const LiveWarning& warning) {
  LogFields fields = {{"warning", warning.kind}};
  if (!warning.robot.empty()) fields.push_back({"robot", warning.robot});
  return fields;
}

const LiveWarning* find_alike(const std::vector<LiveWarning>& warnings, const LiveWarning& one) {
  const auto found =
      std::ranges::find_if(warnings, [&](const LiveWarning& other) { return key_of(other) == key_of(one); });
  return found == warnings.end() ? nullptr : &*found;
}

void tell_begin(const LiveWarning& warning, const Log& log) {
  if (log) log(LogLevel::warning, warning.text, fields_of(warning));
}

void tell_end(const LiveWarning& warning, std::int64_t utime, const Log& log) {
  if (!log) return;
  LogFields fields = fields_of(warning);
  fields.push_back({"seconds", std::to_string((utime - warning.begin_utime) / 1'000'000)});
  log(LogLevel::info, "no longer: " + warning.text, fields);
}

std::string metres(double way_m) {
  char text[32];
  std::snprintf(text, sizeof text, "%.1f", way_m);
  return text;
}

std::string why(const LostRobot& lost) {
  switch (lost.why) {
    case NotFound::way_too_short:
      return "it has driven " + metres(lost.way_m) + " m of the " + metres(lost.min_way_m) +
             " m that a search takes";
    case NotFound::searching:
      return "it is looked for";
    case NotFound::fits_nowhere:
      return "what it sees on its way fits nowhere";
    case NotFound::ambiguous:
      return "what it sees on its way fits two places";
    case NotFound::found_once:
      return "one stretch of its way fits a place; another must agree";
    case NotFound::trying_a_place:
      return "its scans do not fit yet where it may be";
    case NotFound::given_pose_misfits:
      return "its scans do not fit where it was said to be";
    case NotFound::given_pose_ambiguous:
      return "where it was said to be, its scans fit two places, or too wide an area was to be searched";
  }
  return "";
}

}  // namespace

std::vector<LiveWarning> health_warnings_of(const MapCopy& map) {
  std::vector<LiveWarning> warnings;
  for (const HealthRecord& robot : map.health) {
    for (const HealthWarning& warning : robot.warnings)
      warnings.push_back({warning.key, robot.robot, warning.text, 0});
  }
  return warnings;
}

std::vector<LiveWarning> warnings_of_lost(const std::vector<LostRobot>& robots) {
  std::vector<LiveWarning> warnings;
  for (const LostRobot& lost : robots) {
    const bool placed = lost.placed;
    warnings.push_back(
        {placed ? "not_moved" : "not_found", lost.robot,
         lost.robot + (placed ? " stays where it was found: " : " is not found on the map: ") + why(lost),
         0});
  }
  return warnings;
}

std::vector<LiveWarning> warnings_of_annotations(const std::vector<AnnotationRecord>& annotations) {
  constexpr int max_named = 5;
  std::string names;
  int lost = 0;
  for (const AnnotationRecord& annotation : annotations)
    if (annotation.lost && ++lost <= max_named) names += (names.empty() ? "" : ", ") + annotation.name;
  if (lost == 0) return {};
  if (lost > max_named) names += " and " + std::to_string(lost - max_named) + " more";
  return {{"annotation_lost", "",
           "lost with the data of a robot that was dropped, and obeyed by nobody: " + names, 0}};
}

std::vector<LiveWarning> warnings_of_contradictions(const std::vector<SelfContradiction>& found) {
  if (found.empty()) return {};
  const SelfContradiction& most = found.front();
  std::string text = "the map contradicts itself around x " + metres(most.centre_m.x()) + " m, y " +
                     metres(most.centre_m.y()) + " m of island " + std::to_string(most.island.value) +
                     ": a place may be on it twice";
  if (found.size() > 1) text += "; and at " + std::to_string(found.size() - 1) + " more";
  return {{"map_contradicts_itself", "", text, 0}};
}

void LiveWarnings::update(std::vector<LiveWarning> now, std::int64_t utime, const Log& log) {
  std::ranges::stable_sort(now, {}, key_of);
  for (LiveWarning& warning : now) {
    const LiveWarning* before = find_alike(current_, warning);
    warning.begin_utime = before ? before->begin_utime : utime;
    if (!before) tell_begin(warning, log);
  }
  for (const LiveWarning& before : current_) {
    if (!find_alike(now, before)) tell_end(before, utime, log);
  }
  current_ = std::move(now);
}

warning_t warning_message(const LiveWarning& warning) {
  warning_t message{};
  message.kind = warning.kind;
  message.robot = warning.robot;
  message.text = warning.text;
  message.begin_utime = warning.begin_utime;
  return message;
}

}  // namespace isthmus
