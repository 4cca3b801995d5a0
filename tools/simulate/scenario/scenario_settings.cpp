#include "tools/simulate/scenario/scenario_settings.hpp"

#include <filesystem>
#include <fstream>
#include <sstream>
#include <stdexcept>

namespace isthmus {
namespace {

void merge(Setting& into, const Setting& from) {
  auto* fields = std::get_if<Setting::Table>(&into.value);
  const auto* changes = std::get_if<Setting::Table>(&from.value);
  if (fields == nullptr || changes == nullptr) {
    into = from;
    return;
  }
  for (const auto& [key, change] : *changes) {
    const auto [at, added] = fields->try_emplace(key, change);
    if (!added) merge(at->second, change);
  }
}

// All of an override stands on the command line.
void place_at(Setting& setting, const std::string& where) {
  setting.where = where;
  if (auto* fields = std::get_if<Setting::Table>(&setting.value)) {
    for (auto& [key, field] : *fields) place_at(field, where);
  } else if (auto* list = std::get_if<Setting::List>(&setting.value)) {
    for (Setting& element : *list) place_at(element, where);
  }
}

Setting parse_override(const std::string& key, const std::string& value, const std::string& where) {
  try {
    return parse_settings(key + " = " + value, where);
  } catch (const SettingError&) {
  }
  try {
    return parse_settings(key + " = '" + value + "'", where);
  } catch (const SettingError& error) {
    fail_at(where, error.reason);
  }
}

}  // namespace

Setting read_toml(const std::string& file) {
  std::ifstream stream(file);
  if (!stream || std::filesystem::is_directory(file)) throw std::runtime_error(file + ": cannot be read");
  std::ostringstream text;
  text << stream.rdbuf();
  return parse_settings(text.str(), file);
}

void override_setting(Setting& root, const std::string& assignment) {
  const std::string where = override_mark + assignment;
  const std::size_t equals = assignment.find('=');
  if (equals == std::string::npos) fail_at(where, "expected key=value");
  Setting change = parse_override(assignment.substr(0, equals), assignment.substr(equals + 1), where);
  place_at(change, where);
  merge(root, change);
}

Eigen::Vector2d as_point(const Setting& setting) {
  const auto numbers = as_numbers(setting, 2, "[x, y] in metres");
  return {numbers[0], numbers[1]};
}

std::vector<Eigen::Vector2d> as_points(const Setting& setting, std::size_t at_least,
                                       const std::string& what) {
  std::vector<Eigen::Vector2d> points;
  for (const Setting& element : as_list(setting, what)) points.push_back(as_point(element));
  if (points.size() < at_least) fail_at(setting.where, "expected " + what);
  return points;
}

}  // namespace isthmus
