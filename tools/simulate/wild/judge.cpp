#include "tools/simulate/wild/judge.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include "tools/simulate/campaigns/sightings/closures.hpp"
#include "tools/simulate/campaigns/sightings/sightings.hpp"
#include "tools/simulate/run/ray_caster.hpp"
#include "tools/simulate/truth/trajectory_errors.hpp"

namespace isthmus {
namespace {

constexpr double wild_key_spacing_m = 0.5;
constexpr double wild_key_spacing_rad = 0.5;
constexpr double wild_near_m = 3;
constexpr std::int64_t apart_us = 30'000'000;
constexpr double shared_m = 15;  // of two ways: from then on they must be known to be one place

struct Key {
  std::size_t robot = 0;
  TruePose pose;
};

// Scans a little way apart, robot by robot.
std::vector<Key> keys_of(const std::vector<RobotTruth>& truth) {
  std::vector<Key> keys;
  for (std::size_t robot = 0; robot < truth.size(); ++robot) {
    const TruePose* last = nullptr;
    for (const TruePose& pose : truth[robot].poses) {
      if (last != nullptr) {
        const Pose moved = ominus(pose.world_from_robot, last->world_from_robot);
        if (std::hypot(moved.x, moved.y) < wild_key_spacing_m && std::abs(moved.yaw) < wild_key_spacing_rad)
          continue;
      }
      last = &pose;
      keys.push_back({robot, pose});
    }
  }
  return keys;
}

using Cell = std::pair<int, int>;

// Pairs of keys of which each sees where the other was: one of another robot, or of the same long before.
class Neighbours {
 public:
  Neighbours(const Scenario& scenario, const std::vector<Key>& keys) : caster_(scenario.plan), keys_(keys) {
    for (std::size_t i = 0; i < keys.size(); ++i) cells_[cell_of(keys[i])].push_back(i);
  }

  // The nearest of each robot before `i` in the list.
  std::map<std::size_t, std::size_t> of(std::size_t i) const {
    std::map<std::size_t, std::size_t> nearest;
    const Cell middle = cell_of(keys_[i]);
    for (int x = -1; x <= 1; ++x) {
      for (int y = -1; y <= 1; ++y) {
        const auto cell = cells_.find({middle.first + x, middle.second + y});
        if (cell == cells_.end()) continue;
        for (const std::size_t other : cell->second) {
          if (!may_pair(i, other)) continue;
          const auto [at, added] = nearest.try_emplace(keys_[other].robot, other);
          if (!added && distance_m(i, other) < distance_m(i, at->second)) at->second = other;
        }
      }
    }
    return nearest;
  }

 private:
  static Cell cell_of(const Key& key) {
    const Pose& pose = key.pose.world_from_robot;
    return {static_cast<int>(std::floor(pose.x / wild_near_m)),
            static_cast<int>(std::floor(pose.y / wild_near_m))};
  }
  Eigen::Vector2d at(std::size_t i) const { return position(keys_[i].pose.world_from_robot); }
  double distance_m(std::size_t i, std::size_t k) const { return (at(i) - at(k)).norm(); }

  bool may_pair(std::size_t i, std::size_t other) const {
    if (other >= i || distance_m(i, other) > wild_near_m) return false;
    const bool same = keys_[i].robot == keys_[other].robot;
    if (same && keys_[i].pose.utime - keys_[other].pose.utime < apart_us) return false;
    return caster_.line_of_sight(at(i), at(other));
  }

  RayCaster caster_;
  const std::vector<Key>& keys_;
  std::map<Cell, std::vector<std::size_t>> cells_;
};

ScanRelation relation(const std::vector<RobotTruth>& truth, const Key& a, const Key& b) {
  return {truth[a.robot].robot, a.pose.utime, truth[b.robot].robot, b.pose.utime,
          ominus(b.pose.world_from_robot, a.pose.world_from_robot)};
}

// Ways by robot and island; how much of one lies where another was.
std::size_t count_missed_merges(const std::vector<ScanRelation>& relations, const TrajectoryErrors& errors) {
  using RobotOnIsland = std::pair<std::string, IslandId>;
  std::map<std::pair<RobotOnIsland, RobotOnIsland>, double> shared;
  for (const ScanRelation& r : relations) {
    const auto a = errors.island(r.robot1, r.utime1), b = errors.island(r.robot2, r.utime2);
    if (!a || !b || *a == *b) continue;
    const RobotOnIsland first{r.robot1, *a}, second{r.robot2, *b};
    shared[std::minmax(first, second)] += wild_key_spacing_m;
  }
  return static_cast<std::size_t>(
      std::ranges::count_if(shared, [](const auto& one) { return one.second > shared_m; }));
}

void judge_relations(const std::vector<ScanRelation>& relations, const TrajectoryErrors& errors,
                     WildScore& score) {
  for (const ScanRelation& relation : relations) {
    const auto error_m = errors.error_m(relation);
    ++(error_m ? score.relations : score.missing);
    score.mean_m += error_m.value_or(0);
    score.max_m = std::max(score.max_m, error_m.value_or(0));
  }
  if (score.relations > 0) score.mean_m /= static_cast<double>(score.relations);
}

}  // namespace

std::vector<ScanRelation> wild_relations(const Scenario& scenario, const std::vector<RobotTruth>& truth) {
  const std::vector<Key> keys = keys_of(truth);
  const Neighbours neighbours(scenario, keys);
  std::vector<ScanRelation> relations;
  for (std::size_t i = 1; i < keys.size(); ++i) {
    if (keys[i].robot == keys[i - 1].robot) relations.push_back(relation(truth, keys[i - 1], keys[i]));
    for (const auto& [robot, other] : neighbours.of(i))
      relations.push_back(relation(truth, keys[other], keys[i]));
  }
  return relations;
}

WildScore judge_wild(const Scenario& scenario, const SimulatedRun& run, const MapCopy& map) {
  WildScore score;
  const std::vector<ScanRelation> relations = wild_relations(scenario, run.truth);
  const TrajectoryErrors errors(map);
  judge_relations(relations, errors, score);
  score.missed_merges = count_missed_merges(relations, errors);
  const ClosureScore closures = judge_closures(map, run.truth);
  score.islands = closures.islands;
  score.wrong_merges = closures.wrong_merges;
  const SightingScore sightings = judge_sightings(run, map.sightings);
  score.true_sightings = sightings.true_ones;
  score.true_accepted = sightings.true_accepted;
  score.false_sightings = sightings.false_ones;
  score.false_accepted = sightings.false_accepted;
  return score;
}

}  // namespace isthmus
