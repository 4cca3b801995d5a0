#include "server/engine/input/settings.hpp"

#include <toml++/toml.h>
#include <cmath>
#include <limits>
#include <numbers>
#include <sstream>
#include <utility>

#include "server/program/spelling.hpp"

namespace isthmus {
namespace {

std::string place(const std::string& file, const toml::source_region& source) {
  return file + ":" + std::to_string(source.begin.line);
}

Setting convert(const toml::node& node, const std::string& file);

Setting::Table convert_table(const toml::table& table, const std::string& file) {
  Setting::Table fields;
  for (const auto& [key, field] : table) {
    Setting converted = convert(field, file);
    converted.where = place(file, key.source());
    fields.emplace(std::string(key.str()), std::move(converted));
  }
  return fields;
}

Setting::List convert_list(const toml::array& array, const std::string& file) {
  Setting::List list;
  for (const toml::node& element : array) list.push_back(convert(element, file));
  return list;
}

Setting convert(const toml::node& node, const std::string& file) {
  Setting setting{place(file, node.source()), {}};
  if (const toml::table* table = node.as_table()) {
    setting.value = convert_table(*table, file);
  } else if (const toml::array* array = node.as_array()) {
    setting.value = convert_list(*array, file);
  } else if (const auto* truth = node.as_boolean()) {
    setting.value = truth->get();
  } else if (const auto* text = node.as_string()) {
    setting.value = text->get();
  } else if (const auto* integer = node.as_integer()) {
    setting.value = integer->get();
  } else if (const auto* number = node.as_floating_point()) {
    setting.value = number->get();
  } else {
    fail_at(setting.where, "a date or a time has no meaning here");
  }
  return setting;
}

double as_number(const Setting& setting, const std::string& key) {
  const std::optional<double> number = number_of(setting);
  if (!number) fail_at(setting.where, key + " must be a number");
  return *number;
}

template <class T>
const T& as(const Setting& setting, const std::string& key, const char* kind) {
  const T* value = std::get_if<T>(&setting.value);
  if (value == nullptr) fail_at(setting.where, key + " must be " + kind);
  return *value;
}

template <class Number>
void check_bounds(const Setting& setting, const std::string& key, Number value, Number min, Number max) {
  if (value >= min && value <= max) return;  // NaN is not
  std::ostringstream reason;
  reason << key << " = " << value << " is not within " << min << " to " << max;
  fail_at(setting.where, reason.str());
}

}  // namespace

void fail_at(const std::string& where, const std::string& reason) { throw SettingError(where, reason); }

Setting parse_settings(const std::string& toml, const std::string& file) {
  try {
    return convert(toml::parse(toml), file);
  } catch (const toml::parse_error& error) {
    fail_at(place(file, error.source()), std::string(error.description()));
  }
}

Fields::Fields(const Setting& table, std::string name)
    : where_(table.where), name_(std::move(name)), table_(std::get_if<Setting::Table>(&table.value)) {
  if (table_ == nullptr) fail_at(where_, "expected a table");
}

const std::string& Fields::where(const std::string& key) const {
  const auto at = table_->find(key);
  return at == table_->end() ? where_ : at->second.where;
}

const Setting* Fields::find(const std::string& key) {
  known_.insert(key);
  const auto at = table_->find(key);
  return at == table_->end() ? nullptr : &at->second;
}

const Setting* Fields::table(const std::string& key) {
  const Setting* setting = find(key);
  if (setting != nullptr) as<Setting::Table>(*setting, key, "a table");
  return setting;
}

const Setting& Fields::require(const std::string& key) {
  const Setting* setting = find(key);
  if (setting == nullptr) fail_at(where_, "'" + key + "' is missing");
  return *setting;
}

bool Fields::read(const std::string& key, bool& value) {
  const Setting* setting = find(key);
  if (setting != nullptr) value = as<bool>(*setting, key, "true or false");
  return setting != nullptr;
}

bool Fields::read(const std::string& key, double& value) {
  const Setting* setting = find(key);
  if (setting == nullptr) return false;
  const double given = as_number(*setting, key);
  if (!std::isfinite(given)) fail_at(setting->where, key + " must be finite");
  value = given;
  return true;
}

bool Fields::read(const std::string& key, std::string& value) {
  const Setting* setting = find(key);
  if (setting != nullptr) value = as<std::string>(*setting, key, "a string");
  return setting != nullptr;
}

bool Fields::read_degrees(const std::string& key, double& value_rad) {
  double degrees = 0;
  if (!read(key, degrees)) return false;
  value_rad = degrees * std::numbers::pi / 180;
  return true;
}

bool Fields::read_within(const std::string& key, double& value, double min, double max) {
  const Setting* setting = find(key);
  if (setting == nullptr) return false;
  const double given = as_number(*setting, key);
  check_bounds(*setting, key, given, min, max);
  value = given;
  return true;
}

std::int64_t Fields::integer_within(const Setting& setting, const std::string& key, std::int64_t min,
                                    std::int64_t max) {
  const std::int64_t given = as<std::int64_t>(setting, key, "an integer");
  check_bounds(setting, key, given, min, max);
  return given;
}

void Fields::finish() const {
  for (const auto& [key, setting] : *table_) {
    if (known_.contains(key)) continue;
    std::string known;
    for (const std::string& one : known_) known.append(known.empty() ? "" : ", ").append(one);
    std::string reason = "unknown key '";
    reason.append(key).append("'").append(name_).append(did_you_mean(key, {known_.begin(), known_.end()}));
    reason.append(" (known: ").append(known).append(")");
    fail_at(setting.where, reason);
  }
}

std::optional<double> number_of(const Setting& setting) {
  if (const auto* integer = std::get_if<std::int64_t>(&setting.value)) return static_cast<double>(*integer);
  if (const auto* number = std::get_if<double>(&setting.value)) return *number;
  return std::nullopt;
}

const Setting::List& as_list(const Setting& setting, const std::string& what) {
  const auto* list = std::get_if<Setting::List>(&setting.value);
  if (list == nullptr) fail_at(setting.where, "expected " + what);
  return *list;
}

std::vector<double> as_numbers(const Setting& setting, std::size_t count, const std::string& what) {
  std::vector<double> numbers;
  for (const Setting& element : as_list(setting, what)) {
    const double number = number_of(element).value_or(std::numeric_limits<double>::quiet_NaN());
    if (!std::isfinite(number)) fail_at(element.where, "expected " + what);
    numbers.push_back(number);
  }
  if (numbers.size() != count) fail_at(setting.where, "expected " + what);
  return numbers;
}

}  // namespace isthmus
