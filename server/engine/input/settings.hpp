#pragma once

#include <concepts>
#include <cstdint>
#include <map>
#include <optional>
#include <set>
#include <stdexcept>
#include <string>
#include <variant>
#include <vector>

namespace isthmus {

/// A value of a TOML text that remembers where it stood, as "office.toml:12".
struct Setting {
  using List = std::vector<Setting>;
  using Table = std::map<std::string, Setting>;

  std::string where;
  std::variant<bool, std::int64_t, double, std::string, List, Table> value;
};

/// Something wrong with a setting; `what()` is "WHERE: REASON".
struct SettingError : std::runtime_error {
  SettingError(const std::string& where, const std::string& why)
      : std::runtime_error(where + ": " + why), reason(why) {}
  std::string reason;
};

[[noreturn]] void fail_at(const std::string& where, const std::string& reason);

/// Reads TOML; `file` only names where it came from. Throws SettingError.
Setting parse_settings(const std::string& toml, const std::string& file);

/// Reads a table's fields by name, strictly: a field of the wrong type, one out of bounds and (at `finish`)
/// an unknown one throw SettingError. Each table of a file has one reader:
///
///     void read_trial(const Setting& table, TrialOptions& options) {
///       Fields fields(table, " in [tuning.trial]");
///       fields.read_within("min_way_m", options.min_way_m, 0.1, 100);
///       fields.read_within("max_pairs", options.max_pairs, 1, 1000);
///       fields.finish();
///     }
///     if (const Setting* trial = fields.table("trial")) read_trial(*trial, options.trial);
class Fields {
 public:
  /// `name` follows "unknown key 'x'" in errors.
  explicit Fields(const Setting& table, std::string name = "");

  /// Where the table stood, and where the field `key`, or the table for one that is absent.
  const std::string& where() const { return where_; }
  const std::string& where(const std::string& key) const;
  bool has(const std::string& key) const { return table_->contains(key); }

  /// Each leaves `value` as it is where the key is absent, and returns whether it was there. Integers count
  /// as numbers.
  bool read(const std::string& key, bool& value);
  bool read(const std::string& key, double& value);
  bool read(const std::string& key, std::string& value);
  bool read_degrees(const std::string& key, double& value_rad);
  /// The number must lie in [min, max].
  bool read_within(const std::string& key, double& value, double min, double max);
  template <std::integral Integer>
  bool read_within(const std::string& key, Integer& value, std::int64_t min, std::int64_t max) {
    const Setting* setting = find(key);
    if (setting != nullptr) value = static_cast<Integer>(integer_within(*setting, key, min, max));
    return setting != nullptr;
  }

  /// A table inside this one, or nullptr.
  const Setting* table(const std::string& key);
  /// The raw value, or nullptr.
  const Setting* find(const std::string& key);
  const Setting& require(const std::string& key);

  /// Refuses keys that nobody asked for.
  void finish() const;

 private:
  static std::int64_t integer_within(const Setting& setting, const std::string& key, std::int64_t min,
                                     std::int64_t max);

  std::string where_;
  std::string name_;
  const Setting::Table* table_;
  std::set<std::string> known_;
};

/// Nothing for what is no number.
std::optional<double> number_of(const Setting& setting);
/// `what` is what an error says was expected.
const Setting::List& as_list(const Setting& setting, const std::string& what);
/// A list of exactly `count` finite numbers.
std::vector<double> as_numbers(const Setting& setting, std::size_t count, const std::string& what);

}  // namespace isthmus
