#include "tools/evaluate/tags.hpp"

#include <limits>

#include "tools/text/csv.hpp"

namespace isthmus {
namespace {

std::int32_t barcode(const CsvReader& csv) {
  const std::int64_t value = csv.integer("barcode");
  if (value < 0 || value > std::numeric_limits<std::int32_t>::max()) csv.fail("barcode out of range");
  return static_cast<std::int32_t>(value);
}

}  // namespace

std::map<std::int32_t, PlacedTag> read_placed_tags(const std::string& file) {
  CsvReader csv(file);
  std::map<std::int32_t, PlacedTag> tags;
  while (csv.next()) {
    const auto island = static_cast<int>(csv.integer("island"));
    if (island < 0) continue;
    tags[barcode(csv)] = {island, {csv.finite("x_m"), csv.finite("y_m")}};
  }
  return tags;
}

std::map<std::int32_t, Eigen::Vector2d> read_true_tags(const std::string& file) {
  CsvReader csv(file);
  std::map<std::int32_t, Eigen::Vector2d> tags;
  while (csv.next()) {
    if (!tags.emplace(barcode(csv), Eigen::Vector2d(csv.finite("x_m"), csv.finite("y_m"))).second) {
      csv.fail("barcode " + csv.text("barcode") + " twice");
    }
  }
  return tags;
}

}  // namespace isthmus
