#include "tools/simulate/settings.hpp"

#include <toml++/toml.h>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <numbers>
#include <sstream>
#include <stdexcept>

namespace isthmus {
namespace {

constexpr const char* override_source = "--set ";

std::string place(const std::string& file, const toml::source_region& source) {
  if (file.starts_with(override_source)) return file;
  return file + ":" + std::to_string(source.begin.line);
}

Setting convert(const toml::node& node, const std::string& file) {
  Setting setting{place(file, node.source()), {}};
  if (const auto* table = node.as_table()) {
    Setting::Table fields;
    for (const auto& [key, field] : *table) {
      Setting converted = convert(field, file);
      converted.where = place(file, key.source());
      fields.emplace(std::string(key.str()), std::move(converted));
    }
    setting.value = std::move(fields);
  } else if (const auto* array = node.as_array()) {
    Setting::List list;
    for (const auto& element : *array) list.push_back(convert(element, file));
    setting.value = std::move(list);
  } else if (const auto truth = node.value_exact<bool>()) {
    setting.value = *truth;
  } else if (const auto text = node.value_exact<std::string>()) {
    setting.value = *text;
  } else if (const auto number = node.value<double>(); number && node.is_number()) {
    setting.value = *number;
  } else {
    fail_at(setting.where, "a date or a time has no meaning here");
  }
  return setting;
}

Setting parse(const std::string& text, const std::string& file) {
  try {
    return convert(toml::parse(text), file);
  } catch (const toml::parse_error& error) {
    fail_at(place(file, error.source()), std::string(error.description()));
  }
}

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

template <class T>
const T& as(const Setting& setting, const std::string& key, const char* kind) {
  const T* value = std::get_if<T>(&setting.value);
  if (value == nullptr) fail_at(setting.where, "'" + key + "' must be " + kind);
  return *value;
}

double whole_number(const Setting& setting, const std::string& key) {
  const double value = as<double>(setting, key, "a whole number");
  if (value != std::floor(value) || std::abs(value) > 9e15) {
    fail_at(setting.where, "'" + key + "' must be a whole number");
  }
  return value;
}

}  // namespace

void fail_at(const std::string& where, const std::string& reason) {
  throw std::runtime_error(where + ": " + reason);
}

Setting read_toml(const std::string& file) {
  std::ifstream stream(file);
  if (!stream || std::filesystem::is_directory(file)) throw std::runtime_error(file + ": cannot be read");
  std::ostringstream text;
  text << stream.rdbuf();
  return parse(text.str(), file);
}

void override_setting(Setting& root, const std::string& assignment) {
  const std::string source = override_source + assignment;
  const std::size_t equals = assignment.find('=');
  if (equals == std::string::npos) fail_at(source, "expected key=value");
  const std::string key = assignment.substr(0, equals), value = assignment.substr(equals + 1);
  Setting change;
  try {
    change = parse(key + " = " + value, source);
  } catch (const std::runtime_error&) {
    change = parse(key + " = '" + value + "'", source);
  }
  merge(root, change);
}

Fields::Fields(const Setting& table)
    : where_(table.where), table_(std::get_if<Setting::Table>(&table.value)) {
  if (table_ == nullptr) fail_at(where_, "expected a table");
}

const Setting* Fields::find(const std::string& key) {
  used_.insert(key);
  const auto at = table_->find(key);
  return at == table_->end() ? nullptr : &at->second;
}

const Setting& Fields::require(const std::string& key) {
  const Setting* setting = find(key);
  if (setting == nullptr) fail_at(where_, "'" + key + "' is missing");
  return *setting;
}

void Fields::read(const std::string& key, bool& value) {
  if (const Setting* setting = find(key)) value = as<bool>(*setting, key, "true or false");
}

void Fields::read(const std::string& key, double& value) {
  const Setting* setting = find(key);
  if (setting == nullptr) return;
  value = as<double>(*setting, key, "a number");
  if (!std::isfinite(value)) fail_at(setting->where, "'" + key + "' must be finite");
}

void Fields::read(const std::string& key, int& value) {
  const Setting* setting = find(key);
  if (setting == nullptr) return;
  const double number = whole_number(*setting, key);
  if (std::abs(number) > 1e9) fail_at(setting->where, "'" + key + "' is too large");
  value = static_cast<int>(number);
}

void Fields::read(const std::string& key, std::uint64_t& value) {
  const Setting* setting = find(key);
  if (setting == nullptr) return;
  const double number = whole_number(*setting, key);
  if (number < 0) fail_at(setting->where, "'" + key + "' must not be negative");
  value = static_cast<std::uint64_t>(number);
}

void Fields::read(const std::string& key, std::int64_t& value) {
  if (const Setting* setting = find(key)) value = static_cast<std::int64_t>(whole_number(*setting, key));
}

void Fields::read(const std::string& key, std::string& value) {
  if (const Setting* setting = find(key)) value = as<std::string>(*setting, key, "a string");
}

void Fields::read_degrees(const std::string& key, double& value_rad) {
  double degrees = value_rad * 180 / std::numbers::pi;
  if (!has(key)) return;
  read(key, degrees);
  value_rad = degrees * std::numbers::pi / 180;
}

void Fields::read_within(const std::string& key, double& value, double low, double high) {
  read(key, value);
  if (has(key) && !(value >= low && value <= high)) {
    std::ostringstream reason;
    reason << "'" << key << "' must be between " << low << " and " << high;
    fail_at(table_->at(key).where, reason.str());
  }
}

void Fields::finish() const {
  for (const auto& [key, setting] : *table_) {
    if (!used_.contains(key)) fail_at(setting.where, "unknown key '" + key + "'");
  }
}

const Setting::List& as_list(const Setting& setting, const std::string& what) {
  const auto* list = std::get_if<Setting::List>(&setting.value);
  if (list == nullptr) fail_at(setting.where, "expected " + what);
  return *list;
}

std::vector<double> as_numbers(const Setting& setting, std::size_t count, const std::string& what) {
  std::vector<double> numbers;
  for (const Setting& element : as_list(setting, what)) {
    const auto* number = std::get_if<double>(&element.value);
    if (number == nullptr || !std::isfinite(*number)) fail_at(element.where, "expected " + what);
    numbers.push_back(*number);
  }
  if (numbers.size() != count) fail_at(setting.where, "expected " + what);
  return numbers;
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
