#include "tools/import/robot_table.hpp"

#include <limits>
#include <set>

#include "server/engine/input/robot_name.hpp"
#include "tools/text/csv.hpp"

namespace isthmus {
namespace {

std::optional<double> optional_column(const CsvReader& csv, std::string_view column) {
  if (!csv.has_column(column) || csv.text(column).empty()) return std::nullopt;
  return csv.finite(column);
}

RobotRow read_robot(const CsvReader& csv) {
  RobotRow row;
  const std::int64_t barcode = csv.integer("barcode");
  if (barcode < -1 || barcode > std::numeric_limits<std::int32_t>::max()) csv.fail("barcode out of range");
  row.barcode = static_cast<std::int32_t>(barcode);
  row.laser_x_m = optional_column(csv, "laser_x_m");
  row.laser_y_m = optional_column(csv, "laser_y_m");
  row.laser_yaw_rad = optional_column(csv, "laser_yaw_rad");
  row.range_min_m = optional_column(csv, "range_min_m");
  row.range_max_m = optional_column(csv, "range_max_m");
  row.footprint_radius_m = optional_column(csv, "footprint_radius_m");
  return row;
}

}  // namespace

std::optional<std::string> robot_name(const std::string& name) {
  std::string upper = upper_case(name);
  if (!is_robot_name(upper)) return std::nullopt;
  return upper;
}

std::map<std::string, RobotRow> read_robot_table(const std::string& file) {
  CsvReader csv(file);
  std::map<std::string, RobotRow> table;
  std::set<std::int32_t> barcodes;
  while (csv.next()) {
    const auto name = robot_name(csv.text("robot"));
    if (!name) csv.fail("not a robot's name: '" + csv.text("robot") + "'");
    const RobotRow row = read_robot(csv);
    if (row.barcode >= 0 && !barcodes.insert(row.barcode).second) {
      csv.fail("barcode " + std::to_string(row.barcode) + " is another robot's");
    }
    if (!table.emplace(*name, row).second) csv.fail("robot " + *name + " twice");
  }
  return table;
}

}  // namespace isthmus
