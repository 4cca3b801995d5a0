#include "tools/simulate/campaigns/sightings/sightings.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <stdexcept>

#include "server/output/format/csv.hpp"
#include "tools/simulate/campaigns/confidence/confidence.hpp"
#include "tools/simulate/truth/trajectory_errors.hpp"

namespace isthmus {
namespace {

// About a robot's size: of two that stand side by side, a bearing says little of where they are.
constexpr double false_from_m = 0.5;
constexpr std::int64_t longest_gap_us = 500'000;  // between true poses

// Where robots truly were, by name and by barcode.
class Truth {
 public:
  explicit Truth(const SimulatedRun& run) {
    for (const RobotTruth& robot : run.truth) by_name_[robot.robot] = &robot.poses;
    for (const Event& event : run.events) {
      const auto* robot = std::get_if<RobotEvent>(&event.body);
      if (robot != nullptr && robot->barcode >= 0) by_barcode_[robot->barcode] = by_name_.at(robot->robot);
    }
  }

  bool is_false(const SightingEvent& sighting) const {
    const auto named = by_barcode_.find(sighting.barcode);
    if (named == by_barcode_.end()) return true;
    const auto observer = at(*by_name_.at(sighting.robot), sighting.utime);
    const auto target = at(*named->second, sighting.utime);
    if (!observer || !target) return true;
    const TrueSighting truth = true_sighting(*observer, {target->x, target->y}, sighting.barcode);
    const auto point = [](double range_m, double bearing_rad) { return rotate(bearing_rad, {range_m, 0}); };
    return (point(sighting.range_m, sighting.bearing_rad) - point(truth.range_m, truth.bearing_rad)).norm() >
           false_from_m;
  }

 private:
  // Between the poses before and after; nothing where they are far apart in time.
  static std::optional<Pose> at(const std::vector<TruePose>& poses, std::int64_t utime) {
    const auto after = std::ranges::lower_bound(poses, utime, {}, &TruePose::utime);
    if (after != poses.end() && after->utime == utime) return after->world_from_robot;
    if (after == poses.begin() || after == poses.end()) {
      const TruePose& nearest = after == poses.begin() ? poses.front() : poses.back();
      const bool near = !poses.empty() && std::abs(nearest.utime - utime) <= longest_gap_us;
      return near ? std::optional(nearest.world_from_robot) : std::nullopt;
    }
    const TruePose &a = *std::prev(after), &b = *after;
    if (a.stretch != b.stretch || b.utime - a.utime > longest_gap_us) return std::nullopt;
    const double share = static_cast<double>(utime - a.utime) / static_cast<double>(b.utime - a.utime);
    const Pose moved = ominus(b.world_from_robot, a.world_from_robot);
    return a.world_from_robot * Pose{share * moved.x, share * moved.y, share * moved.yaw};
  }

  std::map<std::string, const std::vector<TruePose>*> by_name_;
  std::map<int, const std::vector<TruePose>*> by_barcode_;
};

double ratio_of(double value, double clean) { return clean > 0 ? value / clean : 1; }

}  // namespace

double SightingScore::true_share() const {
  return true_ones == 0 ? 1 : static_cast<double>(true_accepted) / static_cast<double>(true_ones);
}

SightingScore judge_sightings(const SimulatedRun& run, const SightingLog& records) {
  const auto sightings = static_cast<std::size_t>(std::ranges::count_if(
      run.events, [](const Event& event) { return std::holds_alternative<SightingEvent>(event.body); }));
  if (sightings != records.size()) {
    throw std::runtime_error("the map has " + std::to_string(records.size()) + " records of " +
                             std::to_string(sightings) + " sightings");
  }
  const Truth truth(run);
  std::vector<bool> is_false(sightings, false);
  for (const FalseSighting& one : run.false_sightings) is_false[one.row - 1] = truth.is_false(one.reported);
  SightingScore score;
  for (std::size_t i = 0; i < sightings; ++i) {
    const bool accepted = records.verdict(i) == Verdict::accepted;
    ++(is_false[i] ? score.false_ones : score.true_ones);
    if (accepted) ++(is_false[i] ? score.false_accepted : score.true_accepted);
  }
  return score;
}

void RelationComparison::add(const RelationComparison& other) {
  const auto n = static_cast<double>(compared), m = static_cast<double>(other.compared);
  if (compared + other.compared > 0) {
    mean_m = (n * mean_m + m * other.mean_m) / (n + m);
    mean_clean_m = (n * mean_clean_m + m * other.mean_clean_m) / (n + m);
  }
  compared += other.compared;
  missing += other.missing;
  missing_clean += other.missing_clean;
}

RelationComparison compare(const std::vector<ScanRelation>& relations, const MapCopy& map,
                           const MapCopy& clean) {
  const TrajectoryErrors trajectories(map), clean_trajectories(clean);
  RelationComparison sum;
  for (const ScanRelation& relation : relations) {
    const auto error = trajectories.error_m(relation), clean_error = clean_trajectories.error_m(relation);
    const bool both = error && clean_error;
    sum.add(
        {both ? 1U : 0U, error ? 0U : 1U, clean_error ? 0U : 1U, both ? *error : 0, both ? *clean_error : 0});
  }
  return sum;
}

double SightingTrial::error_ratio() const {
  RelationComparison all = intra;
  all.add(inter);
  return ratio_of(all.mean_m, all.mean_clean_m);
}

SightingTrial try_sightings(const Scenario& scenario, std::uint64_t seed, double false_share,
                            const Configuration& configuration) {
  Scenario spoilt = scenario, clean = scenario;
  spoilt.false_sightings = false_share;
  clean.false_sightings = 0;
  const SimulatedRun run = simulate(spoilt, seed), clean_run = simulate(clean, seed);
  const MapCopy map = map_events(run.events, configuration),
                clean_map = map_events(clean_run.events, configuration);
  SightingTrial trial;
  trial.seed = seed;
  trial.score = judge_sightings(run, map.sightings);
  trial.clean_score = judge_sightings(clean_run, clean_map.sightings);
  trial.islands = map.graph.islands().size();
  trial.clean_islands = clean_map.graph.islands().size();
  std::vector<ScanRelation> intra = sample_relations(run.truth, seed), inter;
  std::erase_if(intra, [&](const ScanRelation& relation) {
    if (relation.robot1 != relation.robot2) inter.push_back(relation);
    return relation.robot1 != relation.robot2;
  });
  trial.intra = compare(intra, map, clean_map);
  trial.inter = compare(inter, map, clean_map);
  return trial;
}

void write_trials(const std::vector<SightingTrial>& trials, const std::string& file) {
  CsvFile csv(file,
              "seed,islands,islands_clean,false,false_accepted,true,true_accepted,true_clean,"
              "true_accepted_clean,intra,intra_missing,intra_missing_clean,intra_m,intra_clean_m,"
              "inter,inter_missing,inter_missing_clean,inter_m,inter_clean_m,error_ratio");
  for (const SightingTrial& t : trials) {
    csv.row(t.seed, t.islands, t.clean_islands, t.score.false_ones, t.score.false_accepted, t.score.true_ones,
            t.score.true_accepted, t.clean_score.true_ones, t.clean_score.true_accepted, t.intra.compared,
            t.intra.missing, t.intra.missing_clean, t.intra.mean_m, t.intra.mean_clean_m, t.inter.compared,
            t.inter.missing, t.inter.missing_clean, t.inter.mean_m, t.inter.mean_clean_m, t.error_ratio());
  }
  csv.commit();
}

}  // namespace isthmus
