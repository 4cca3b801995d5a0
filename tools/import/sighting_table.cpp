#include "tools/import/sighting_table.hpp"

#include <cmath>
#include <limits>

#include "tools/import/robot_table.hpp"
#include "tools/text/csv.hpp"

namespace isthmus {
namespace {

double sigma(const CsvReader& csv, std::string_view column) {
  const double value = csv.number(column);
  if (!(value > 0)) csv.fail("not a positive sigma in column " + std::string(column));
  return value;
}

/// A measured value; where its sigma is infinite there is none, and it may be anything.
double measured(const CsvReader& csv, std::string_view column, double sigma) {
  if (std::isfinite(sigma)) return csv.finite(column);
  const double value = csv.text(column).empty() ? 0 : csv.number(column);
  return std::isfinite(value) ? value : 0;
}

SightingEvent read_sighting(const CsvReader& csv) {
  SightingEvent sighting;
  const auto name = robot_name(csv.text("observer"));
  if (!name) csv.fail("not a robot's name: '" + csv.text("observer") + "'");
  sighting.robot = *name;
  sighting.utime = csv.integer("utime_us");
  const std::int64_t barcode = csv.integer("barcode");
  if (barcode < 0 || barcode > std::numeric_limits<std::int32_t>::max()) csv.fail("barcode out of range");
  sighting.barcode = static_cast<std::int32_t>(barcode);
  sighting.range_sigma_m = sigma(csv, "range_std_m");
  sighting.bearing_sigma_rad = sigma(csv, "bearing_std_rad");
  sighting.range_m = measured(csv, "range_m", sighting.range_sigma_m);
  sighting.bearing_rad = measured(csv, "bearing_rad", sighting.bearing_sigma_rad);
  return sighting;
}

}  // namespace

std::vector<SightingEvent> read_sighting_table(const std::string& file, bool skip_bad_lines,
                                               long& bad_lines) {
  CsvReader csv(file);
  for (const char* column :
       {"utime_us", "observer", "barcode", "range_m", "bearing_rad", "range_std_m", "bearing_std_rad"}) {
    if (!csv.has_column(column)) csv.fail(std::string("no column '") + column + "' in the header");
  }
  std::vector<SightingEvent> sightings;
  while (true) {
    try {
      if (!csv.next()) return sightings;
      sightings.push_back(read_sighting(csv));
    } catch (const TruncatedFile&) {
      if (!skip_bad_lines) throw;
      ++bad_lines;
      return sightings;
    } catch (const FileError&) {
      if (!skip_bad_lines) throw;
      ++bad_lines;
    }
  }
}

}  // namespace isthmus
