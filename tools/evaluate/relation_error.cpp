#include "tools/evaluate/relation_error.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "server/engine/input/robot_name.hpp"
#include "tools/text/csv.hpp"
#include "tools/text/lines.hpp"
#include "tools/text/numbers.hpp"

namespace isthmus {
namespace {

constexpr double degrees = 180 / std::numbers::pi;

struct Samples {
  std::size_t missing = 0;
  std::vector<double> translation_m;
  std::vector<double> rotation_deg;
};

void compare(const TrueRelation& truth, const TeamTrajectories& team, Samples& samples) {
  const std::optional<Pose> error = relation_error(truth, team);
  if (!error) {
    ++samples.missing;
    return;
  }
  samples.translation_m.push_back(std::hypot(error->x, error->y));
  samples.rotation_deg.push_back(std::abs(error->yaw) * degrees);
}

std::vector<double> squared(std::vector<double> values) {
  for (double& value : values) value *= value;
  return values;
}

}  // namespace

std::vector<TrueRelation> read_benchmark_relations(const std::string& file, const std::string& robot) {
  LineReader lines(file);
  std::vector<TrueRelation> relations;
  std::vector<std::string_view> words;
  while (const auto line = lines.next()) {
    split_words(*line, words);
    if (words.empty() || words[0][0] == '#') continue;
    const std::string expected = "expected 't1 t2 x y z roll pitch yaw'";
    if (words.size() != 8) throw FileError(file, lines.number(), "wrong count of fields: " + expected);
    const auto utime1 = parse_seconds_as_us(words[0]);
    const auto utime2 = parse_seconds_as_us(words[1]);
    const auto x = parse_double(words[2]);
    const auto y = parse_double(words[3]);
    const auto yaw = parse_double(words[7]);
    if (!utime1 || !utime2 || !x || !y || !yaw) {
      throw FileError(file, lines.number(), "not a number: " + expected);
    }
    relations.push_back({robot, *utime1, robot, *utime2, {*x, *y, wrap_angle(*yaw)}, "intra"});
  }
  return relations;
}

std::vector<TrueRelation> read_team_relations(const std::string& file) {
  CsvReader csv(file);
  std::vector<TrueRelation> relations;
  while (csv.next()) {
    relations.push_back({upper_case(csv.text("robot1")),
                         csv.integer("utime1_us"),
                         upper_case(csv.text("robot2")),
                         csv.integer("utime2_us"),
                         {csv.finite("x_m"), csv.finite("y_m"), wrap_angle(csv.finite("yaw_rad"))},
                         csv.text("kind")});
  }
  return relations;
}

Statistics statistics(std::vector<double> values) {
  Statistics result;
  if (values.empty()) return result;
  const auto n = static_cast<double>(values.size());
  double squares_of_values = 0;
  for (const double value : values) {
    result.mean += value / n;
    squares_of_values += value * value;
  }
  result.rms = std::sqrt(squares_of_values / n);
  double squares = 0;
  for (const double value : values) squares += (value - result.mean) * (value - result.mean);
  if (values.size() > 1) result.deviation = std::sqrt(squares / (n - 1));
  std::sort(values.begin(), values.end());
  const std::size_t half = values.size() / 2;
  result.median = values.size() % 2 == 1 ? values[half] : (values[half - 1] + values[half]) / 2;
  result.max = values.back();
  return result;
}

std::optional<Pose> relation_error(const TrueRelation& truth, const TeamTrajectories& team) {
  const auto pose1 = team.pose(truth.robot1, truth.utime1);
  const auto pose2 = team.pose(truth.robot2, truth.utime2);
  if (!pose1 || !pose2 || pose1->island != pose2->island) return std::nullopt;
  const Pose from_1_to_2 = ominus(pose2->map_from_robot, pose1->map_from_robot);
  return Pose{from_1_to_2.x - truth.from_1_to_2.x, from_1_to_2.y - truth.from_1_to_2.y,
              wrap_angle(from_1_to_2.yaw - truth.from_1_to_2.yaw)};
}

std::map<std::string, RelationErrors> evaluate_relations(const std::vector<TrueRelation>& relations,
                                                         const TeamTrajectories& team) {
  std::map<std::string, Samples> by_kind;
  for (const TrueRelation& relation : relations) compare(relation, team, by_kind[relation.kind]);
  std::map<std::string, RelationErrors> errors;
  for (const auto& [kind, samples] : by_kind) {
    errors[kind] = {samples.translation_m.size(),
                    samples.missing,
                    statistics(samples.translation_m),
                    statistics(samples.rotation_deg),
                    statistics(squared(samples.translation_m)),
                    statistics(squared(samples.rotation_deg))};
  }
  return errors;
}

}  // namespace isthmus
