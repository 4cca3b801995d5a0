#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <map>
#include <set>
#include <string>
#include <variant>
#include <vector>

namespace isthmus {

/// A value of a TOML file that remembers where it stood, as "office.toml:12".
struct Setting {
  using List = std::vector<Setting>;
  using Table = std::map<std::string, Setting>;

  std::string where;
  std::variant<bool, double, std::string, List, Table> value;
};

/// Reads a TOML file. Throws std::runtime_error "FILE:LINE: reason".
Setting read_toml(const std::string& file);

/// Applies "key.path=value", the value in TOML's notation or a bare string, over what the file says.
void override_setting(Setting& root, const std::string& assignment);

[[noreturn]] void fail_at(const std::string& where, const std::string& reason);

/// Reads a table's fields by name, strictly: a field of the wrong type, a missing one and (at `finish`) an
/// unknown one throw std::runtime_error naming file and line.
class Fields {
 public:
  explicit Fields(const Setting& table);

  const std::string& where() const { return where_; }
  bool has(const std::string& key) const { return table_->contains(key); }

  /// Each leaves `value` as it is where the key is absent.
  void read(const std::string& key, bool& value);
  void read(const std::string& key, double& value);
  void read(const std::string& key, int& value);
  void read(const std::string& key, std::uint64_t& value);
  void read(const std::string& key, std::int64_t& value);
  void read(const std::string& key, std::string& value);
  void read_degrees(const std::string& key, double& value_rad);
  /// As `read`, and the number must lie in [low, high].
  void read_within(const std::string& key, double& value, double low, double high);

  /// The raw value, or nullptr.
  const Setting* find(const std::string& key);
  const Setting& require(const std::string& key);

  void finish() const;

 private:
  std::string where_;
  const Setting::Table* table_;
  std::set<std::string> used_;
};

const Setting::List& as_list(const Setting& setting, const std::string& what);
/// A list of exactly `count` numbers.
std::vector<double> as_numbers(const Setting& setting, std::size_t count, const std::string& what);
Eigen::Vector2d as_point(const Setting& setting);
std::vector<Eigen::Vector2d> as_points(const Setting& setting, std::size_t at_least, const std::string& what);

}  // namespace isthmus
