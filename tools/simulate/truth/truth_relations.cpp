#include <cmath>
#include <optional>

#include "tools/simulate/plan/random.hpp"
#include "tools/simulate/truth/truth_files.hpp"

namespace isthmus {
namespace {

constexpr double key_spacing_m = 0.5;
constexpr double key_spacing_rad = 0.3;
constexpr double near_m = 10;
constexpr std::int64_t long_term_us = 30'000'000;
constexpr std::size_t max_long_term = 500;  // for each robot
constexpr std::size_t max_between = 300;    // for each pair of robots
constexpr int tries = 50;

using Keys = std::vector<TruePose>;

// Scans a little way apart, so that a robot that stands does not count.
Keys keys_of(const RobotTruth& truth) {
  Keys keys;
  for (const TruePose& pose : truth.poses) {
    if (!keys.empty() && keys.back().stretch == pose.stretch) {
      const Pose moved = ominus(pose.world_from_robot, keys.back().world_from_robot);
      if (std::hypot(moved.x, moved.y) < key_spacing_m && std::abs(moved.yaw) < key_spacing_rad) continue;
    }
    keys.push_back(pose);
  }
  return keys;
}

ScanRelation relation(const std::string& robot1, const TruePose& a, const std::string& robot2,
                      const TruePose& b) {
  return {robot1, a.utime, robot2, b.utime, ominus(b.world_from_robot, a.world_from_robot)};
}

double distance(const TruePose& a, const TruePose& b) {
  return std::hypot(a.world_from_robot.x - b.world_from_robot.x, a.world_from_robot.y - b.world_from_robot.y);
}

void add_short_term(const std::string& robot, const Keys& keys, std::vector<ScanRelation>& relations) {
  for (std::size_t i = 1; i < keys.size(); ++i) {
    if (keys[i].stretch == keys[i - 1].stretch)
      relations.push_back(relation(robot, keys[i - 1], robot, keys[i]));
  }
}

// A random pair that satisfies `fits`, or nothing.
template <class Fits>
std::optional<std::pair<TruePose, TruePose>> pick(const Keys& a, const Keys& b, Random& random, Fits fits) {
  for (int i = 0; i < tries && !a.empty() && !b.empty(); ++i) {
    const TruePose& first = a[random.index(a.size())];
    const TruePose& second = b[random.index(b.size())];
    if (fits(first, second)) return std::pair(first, second);
  }
  return std::nullopt;
}

}  // namespace

std::vector<ScanRelation> sample_relations(const std::vector<RobotTruth>& truth, std::uint64_t seed) {
  Random random(seed, "relations");
  std::vector<Keys> keys;
  std::vector<ScanRelation> relations;
  for (const RobotTruth& robot : truth) keys.push_back(keys_of(robot));
  for (std::size_t i = 0; i < truth.size(); ++i) {
    add_short_term(truth[i].robot, keys[i], relations);
    const auto long_term = [](const TruePose& a, const TruePose& b) {
      return a.stretch == b.stretch && b.utime - a.utime >= long_term_us && distance(a, b) < near_m;
    };
    for (std::size_t n = 0; n < std::min(max_long_term, keys[i].size()); ++n) {
      if (const auto pair = pick(keys[i], keys[i], random, long_term)) {
        relations.push_back(relation(truth[i].robot, pair->first, truth[i].robot, pair->second));
      }
    }
  }
  const auto near = [](const TruePose& a, const TruePose& b) { return distance(a, b) < near_m; };
  for (std::size_t i = 0; i < truth.size(); ++i) {
    for (std::size_t j = i + 1; j < truth.size(); ++j) {
      for (std::size_t n = 0; n < std::min(max_between, keys[i].size()); ++n) {
        if (const auto pair = pick(keys[i], keys[j], random, near)) {
          relations.push_back(relation(truth[i].robot, pair->first, truth[j].robot, pair->second));
        }
      }
    }
  }
  return relations;
}

}  // namespace isthmus
