#include "server/feature_maps/output/feature_files.hpp"

#include <openssl/evp.h>

#include <array>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>
#include <stdexcept>

#include "server/feature_maps/output/feature_source.hpp"
#include "server/output/format/csv.hpp"
#include "server/output/format/tum.hpp"
#include "server/output/stale.hpp"
#include "server/output/tables/trajectories.hpp"
#include "server/output/vector_plan/plan_files.hpp"

namespace isthmus {
namespace {

using Json = nlohmann::ordered_json;

constexpr double nan = std::numeric_limits<double>::quiet_NaN();

void write(const std::string& path, const std::string& text) {
  AtomicFile file(path);
  file.write(text);
  file.commit();
}

/// Upper triangle of the covariance of x_p by all four components.
std::array<double, 10> covariance_of(const FeatureState& state, std::size_t index) {
  const std::array<bool, 4> known = known_components(state.features[index].feature);
  const LocalMatrix covariance = feature_covariance(state, index);
  std::array<Eigen::Index, 4> row{};
  for (std::size_t i = 1; i < 4; ++i) row[i] = row[i - 1] + (known[i - 1] ? 1 : 0);
  std::array<double, 10> values{};
  std::size_t at = 0;
  for (std::size_t i = 0; i < 4; ++i)
    for (std::size_t k = i; k < 4; ++k)
      values[at++] = known[i] && known[k] ? covariance(row[i], row[k]) : nan;
  return values;
}

std::string feature_row(const FeatureState& state, std::size_t index, std::size_t island,
                        std::int32_t barcode) {
  const FeatureInState& entry = state.features[index];
  const Feature& f = entry.feature;
  const bool two = point_count(f.kind) == 2;
  std::string row = std::to_string(island) + ',' + std::to_string(entry.id) + ',' +
                    std::string(name(f.kind)) + ',' + (barcode >= 0 ? std::to_string(barcode) : "");
  for (const double value : {f.a.x(), f.a.y(), two ? f.b.x() : nan, two ? f.b.y() : nan,
                             f.kind == FeatureKind::pole && f.radius_known ? f.radius_m : nan})
    row += ',' + csv_field(value);
  row += ',' + std::to_string(entry.seen);
  for (const double value : covariance_of(state, index)) row += ',' + csv_field(value);
  return row + '\n';
}

std::map<int, std::int32_t> barcodes_of(const Team& team) {
  std::map<int, std::int32_t> barcodes;
  for (const auto& [barcode, id] : team.landmarks) barcodes[id] = barcode;
  return barcodes;
}

std::string tum(const Journey& journey) {
  std::string text;
  for (const JourneyRow& row : journey.rows) text += tum_line(row.utime, row.map_from_robot);
  return text;
}

std::vector<std::string> write_journeys(const FeatureMaps& maps, const std::string& directory) {
  std::map<std::string, std::string> of_robot;
  for (const Journey& journey : maps.journeys) of_robot[journey.robot] += tum(journey);
  std::vector<std::string> robots;
  for (const auto& [robot, text] : of_robot) {
    write(directory + "/trajectories/" + file_name_of(robot) + ".tum", text);
    robots.push_back(robot);
  }
  CsvFile csv(directory + "/robots.csv", "robot,island,from_s,to_s");
  for (const Journey& journey : maps.journeys)
    if (!journey.rows.empty())
      csv.row(journey.robot, journey.team, seconds(journey.rows.front().utime),
              seconds(journey.rows.back().utime));
  csv.commit();
  return robots;
}

void write_sightings(const FeatureMaps& maps, const std::string& path) {
  CsvFile csv(
      path,
      "utime_us,observer,barcode,range_m,bearing_rad,range_std_m,bearing_std_rad,verdict,reason,closure");
  for (const auto& [s, used, reason, fusion] : maps.sightings)
    csv.row(s.utime, s.robot, s.barcode, s.range_m, s.bearing_rad, s.range_sigma_m, s.bearing_sigma_rad,
            used ? "used" : "not_used", reason, fusion >= 0 ? std::to_string(fusion) : "");
  csv.commit();
}

void write_tags(const FeatureMaps& maps, const std::string& path) {
  CsvFile csv(path, "barcode,island,x_m,y_m,cov_x_x,cov_x_y,cov_y_y");
  for (std::size_t k = 0; k < maps.teams.size(); ++k) {
    const FeatureState& state = maps.teams[k].filter.state();
    for (const auto& [barcode, id] : maps.teams[k].landmarks) {
      const auto index = index_of(state, id);
      if (!index) continue;
      const LocalMatrix c = feature_covariance(state, *index);
      const Eigen::Vector2d& at = state.features[*index].feature.a;
      csv.row(barcode, k, at.x(), at.y(), c(0, 0), c(0, 1), c(1, 1));
    }
  }
  csv.commit();
}

Json counts_of_sightings(const FeatureMaps& maps) {
  std::map<std::string, std::int64_t> reasons;
  for (const FeatureSighting& sighting : maps.sightings) ++reasons[sighting.used ? "used" : sighting.reason];
  Json object = Json::object();
  for (const auto& [reason, count] : reasons) object[reason] = count;
  return object;
}

Json islands_of(const FeatureMaps& maps) {
  Json list = Json::array();
  for (const Team& team : maps.teams) {
    Json robots = Json::array();
    for (const int number : team.journeys)
      robots.push_back(maps.journeys[static_cast<std::size_t>(number)].robot);
    list.push_back({{"features", team.filter.state().features.size()}, {"robots", std::move(robots)}});
  }
  return list;
}

Json closures_of(const FeatureMaps& maps) {
  Json list = Json::array();
  for (const FusionRecord& fusion : maps.fusions)
    list.push_back({{"id", fusion.id},
                    {"kind", "merge"},
                    {"by", fusion.placing ? "walls" : "sightings"},
                    {"state", word(fusion.state)},
                    {"utime", fusion.utime},
                    {"robots", fusion.robots},
                    {"sightings", fusion.clues},
                    {"duplicates", fusion.duplicates},
                    {"log_odds",
                     {{"sightings", fusion.clues_log_odds},
                      {"duplicates", fusion.twins_log_odds},
                      {"since", fusion.since_log_odds}}}});
  return list;
}

std::string report_json(const FeatureMaps& maps, const RunCost& cost) {
  const FeatureCounts& counts = maps.counts;
  const double log_s = 1e-6 * static_cast<double>(counts.last_receive_utime - counts.first_receive_utime);
  const Json report = {{"estimator", maps.kind == FeatureMapKind::segments ? "segments" : "points"},
                       {"events", counts.events},
                       {"scans", counts.scans},
                       {"scans_used", counts.scans_used},
                       {"scans_tracked", counts.scans_tracked},
                       {"segments_seen", counts.segments_seen},
                       {"segments_paired", counts.segments_paired},
                       {"features_contradicted", counts.contradicted},
                       {"sightings", counts_of_sightings(maps)},
                       {"dropped", Json(counts.dropped)},
                       {"fusions", counts.fusions},
                       {"fusions_withdrawn", counts.withdrawn},
                       {"closures", closures_of(maps)},
                       {"islands", maps.teams.size()},
                       {"island_list", islands_of(maps)},
                       {"map_bytes", features_csv(maps).size()},
                       {"log_duration_s", log_s},
                       {"wall_s", cost.wall_s},
                       {"cpu_s", cost.cpu_s},
                       {"realtime_factor", cost.wall_s > 0 ? log_s / cost.wall_s : 0.0},
                       {"peak_rss_mb", cost.peak_rss_mb},
                       {"map_sha256", map_sha256(maps)}};
  return report.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

void write_plan(const Team& team, std::size_t island, const std::string& directory) {
  PlanOptions options;
  options.stretches.min_views = 1;  // a feature was seen often before it was one
  options.poles.min_views = 1;
  write_plan_files(fit_plan(plan_source(team.filter.state()), options), island, directory);
}

}  // namespace

std::string features_csv(const FeatureMaps& maps) {
  std::string text =
      "island,id,kind,barcode,ax_m,ay_m,bx_m,by_m,radius_m,seen,cov_0_0,cov_0_1,cov_0_2,cov_0_3,cov_1_1,"
      "cov_1_2,cov_1_3,cov_2_2,cov_2_3,cov_3_3\n";
  for (std::size_t k = 0; k < maps.teams.size(); ++k) {
    const FeatureState& state = maps.teams[k].filter.state();
    const std::map<int, std::int32_t> barcodes = barcodes_of(maps.teams[k]);
    for (std::size_t i = 0; i < state.features.size(); ++i) {
      const auto barcode = barcodes.find(state.features[i].id);
      text += feature_row(state, i, k, barcode == barcodes.end() ? -1 : barcode->second);
    }
  }
  return text;
}

std::string map_sha256(const FeatureMaps& maps) {
  std::string text = features_csv(maps);
  for (const Journey& journey : maps.journeys) {
    text += csv_field(journey.robot) + ',' + std::to_string(journey.team) + '\n';
    for (const JourneyRow& row : journey.rows)
      text += std::to_string(row.utime) + ',' + number(row.map_from_robot.x) + ',' +
              number(row.map_from_robot.y) + ',' + number(row.map_from_robot.yaw) + '\n';
  }
  std::array<unsigned char, EVP_MAX_MD_SIZE> digest{};
  unsigned int size = 0;
  if (EVP_Digest(text.data(), text.size(), digest.data(), &size, EVP_sha256(), nullptr) != 1)
    throw std::runtime_error("SHA-256 is not available from OpenSSL");
  std::string hex;
  for (unsigned int i = 0; i < size; ++i) {
    constexpr const char* digits = "0123456789abcdef";
    hex += digits[digest[i] >> 4];
    hex += digits[digest[i] & 15];
  }
  return hex;
}

void write_outputs(const FeatureMaps& maps, const RunCost& cost, const std::string& directory) {
  make_directory(directory + "/trajectories");
  const std::vector<std::string> robots = write_journeys(maps, directory);
  write(directory + "/features.csv", features_csv(maps));
  write_sightings(maps, directory + "/sightings.csv");
  write_tags(maps, directory + "/tags.csv");
  for (std::size_t k = 0; k < maps.teams.size(); ++k) write_plan(maps.teams[k], k, directory);
  remove_stale(directory, maps.teams.size(), robots);
  write(directory + "/report.json", report_json(maps, cost));
}

}  // namespace isthmus
