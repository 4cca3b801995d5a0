#include "tools/simulate/campaigns/floor_plans/floor_plans.hpp"

#include <algorithm>
#include <cmath>
#include <ctime>
#include <limits>
#include <map>
#include <string>
#include <utility>

#include "server/output/tables/islands.hpp"
#include "server/output/vector_plan/map_source.hpp"
#include "tools/evaluate/alignment.hpp"
#include "tools/simulate/campaigns/confidence/confidence.hpp"
#include "tools/simulate/truth/true_patches.hpp"

namespace isthmus {
namespace {

constexpr double sample_step_m = 0.05;
constexpr double found_m = 0.05;
constexpr double true_m = 0.1;
constexpr int min_hits = 10;
constexpr double min_wall_m = 1;

template <class Visit>
void sample(const Eigen::Vector2d& a, const Eigen::Vector2d& b, const Visit& visit) {
  const int parts = std::max(1, static_cast<int>(std::lround((b - a).norm() / sample_step_m)));
  for (int i = 0; i < parts; ++i) visit(a + (b - a) * ((i + 0.5) / parts), (b - a).norm() / parts);
}

/// How many beams hit each cell of 5 cm.
class HitCells {
 public:
  explicit HitCells(const SimulatedRun& run) {
    std::map<std::pair<std::string, std::int64_t>, Pose> poses;
    for (const RobotTruth& robot : run.truth)
      for (const TruePose& pose : robot.poses) poses[{robot.robot, pose.utime}] = pose.world_from_robot;
    std::map<std::string, Laser> lasers;
    for (const Event& event : run.events) {
      if (const auto* robot = std::get_if<RobotEvent>(&event.body)) lasers[robot->robot] = robot->laser;
      if (const auto* scan = std::get_if<ScanEvent>(&event.body)) {
        const auto pose = poses.find({scan->robot, scan->scan.utime});
        if (pose != poses.end()) add(scan->scan, lasers[scan->robot], pose->second);
      }
    }
  }

  int near(const Eigen::Vector2d& point) const {
    int hits = 0;
    const auto [x, y] = cell_of(point);
    for (int dx = -1; dx <= 1; ++dx) {
      for (int dy = -1; dy <= 1; ++dy) {
        const auto found = counts_.find({x + dx, y + dy});
        if (found != counts_.end()) hits += found->second;
      }
    }
    return hits;
  }

 private:
  static std::pair<int, int> cell_of(const Eigen::Vector2d& point) {
    return {static_cast<int>(std::floor(point.x() / sample_step_m)),
            static_cast<int>(std::floor(point.y() / sample_step_m))};
  }

  void add(const Scan& scan, const Laser& laser, const Pose& world_from_robot) {
    for (const ScanPoint& point : to_points(scan, laser, {}))
      ++counts_[cell_of(world_from_robot * point.position)];
  }

  std::map<std::pair<int, int>, int> counts_;
};

template <class Lines>
double distance_to(const Eigen::Vector2d& point, const Lines& lines) {
  double nearest = std::numeric_limits<double>::infinity();
  for (const auto& line : lines) nearest = std::min(nearest, distance_m(point, Segment{line.a, line.b}));
  return nearest;
}

std::vector<PlanWall> in_world(const VectorPlan& plan, const Pose& world_from_map) {
  std::vector<PlanWall> walls = plan.walls;
  for (PlanWall& wall : walls) {
    wall.a = world_from_map * wall.a;
    wall.b = world_from_map * wall.b;
  }
  return walls;
}

void judge_what_is_drawn(const std::vector<PlanWall>& walls, const FloorPlan& floor, PlanScore& score) {
  std::vector<double> distances;
  double squares = 0, false_m = 0;
  for (const PlanWall& wall : walls) {
    sample(wall.a, wall.b, [&](const Eigen::Vector2d& point, double length) {
      score.drawn_m += length;
      const double distance = distance_to(point, floor.segments);
      if (distance > true_m) {
        false_m += length;
      } else {
        squares += distance * distance;
        distances.push_back(distance);
      }
    });
  }
  if (distances.empty()) return;
  std::sort(distances.begin(), distances.end());
  score.rms_m = std::sqrt(squares / static_cast<double>(distances.size()));
  score.worst_5_m = distances[distances.size() * 95 / 100];
  score.false_share = false_m / score.drawn_m;
}

bool is_of_a_pole(const Eigen::Vector2d& point, const VectorPlan& plan, const Pose& world_from_map) {
  return std::any_of(plan.poles.begin(), plan.poles.end(), [&](const PlanPole& pole) {
    return std::abs((world_from_map * pole.centre - point).norm() - pole.radius_m) <= found_m;
  });
}

/// The length of the straight face that each segment is part of: rough walls are made of pieces.
std::vector<double> face_lengths(const std::vector<Segment>& segments) {
  std::vector<double> lengths(segments.size());
  for (std::size_t first = 0; first < segments.size();) {
    std::size_t last = first + 1;
    const auto goes_on = [&] {
      const Eigen::Vector2d before = (segments[last - 1].b - segments[last - 1].a).normalized();
      const Eigen::Vector2d after = (segments[last].b - segments[last].a).normalized();
      return segments[last].a == segments[last - 1].b && before.dot(after) > std::cos(0.1);
    };
    while (last < segments.size() && goes_on()) ++last;
    const double length = (segments[last - 1].b - segments[first].a).norm();
    for (; first < last; ++first) lengths[first] = length;
  }
  return lengths;
}

void judge_what_is_found(const VectorPlan& plan, const Pose& world_from_map, const FloorPlan& floor,
                         const HitCells& hits, PlanScore& score) {
  const std::vector<PlanWall> walls = in_world(plan, world_from_map);
  const std::vector<double> lengths = face_lengths(floor.segments);
  double found = 0, walls_found = 0;
  for (std::size_t i = 0; i < floor.segments.size(); ++i) {
    const bool is_wall = lengths[i] >= min_wall_m;
    sample(floor.segments[i].a, floor.segments[i].b, [&](const Eigen::Vector2d& point, double length) {
      if (hits.near(point) < min_hits) return;
      const bool here = distance_to(point, walls) <= found_m || is_of_a_pole(point, plan, world_from_map);
      score.seen_m += length;
      found += here ? length : 0;
      score.walls_seen_m += is_wall ? length : 0;
      walls_found += is_wall && here ? length : 0;
    });
  }
  if (score.seen_m > 0) score.found_share = found / score.seen_m;
  if (score.walls_seen_m > 0) score.walls_found_share = walls_found / score.walls_seen_m;
}

double cpu_now_s() { return static_cast<double>(std::clock()) / CLOCKS_PER_SEC; }

Pose place_in_world(const MapCopy& map, const std::vector<PatchId>& island, const SimulatedRun& run) {
  const std::vector<std::optional<TruePatch>> truth = true_patches(map, run.truth);
  std::vector<PosePair> pairs;
  for (const PatchId id : island) {
    const auto i = static_cast<std::size_t>(id.value);
    if (truth[i]) pairs.push_back({truth[i]->world_from_patch, map.poses[i]});
  }
  return align(pairs);
}

}  // namespace

PlanScore score_plan(const VectorPlan& plan, const Pose& world_from_map, const FloorPlan& floor,
                     const SimulatedRun& run) {
  PlanScore score;
  score.walls = plan.walls.size();
  score.openings = plan.openings.size();
  score.poles = plan.poles.size();
  const std::vector<PlanWall> walls = in_world(plan, world_from_map);
  judge_what_is_drawn(walls, floor, score);
  judge_what_is_found(plan, world_from_map, floor, HitCells(run), score);
  return score;
}

PlanScore try_floor_plan(const Scenario& scenario, std::uint64_t seed, const PlanOptions& options) {
  const SimulatedRun run = simulate(scenario, seed);
  const MapCopy map = map_events(run.events);
  const RankedIslands islands = rank_islands(map);
  if (islands.patches.empty()) return {};
  const double start_s = cpu_now_s();
  const VectorPlan plan = fit_plan(plan_source(map, islands.patches[0], options.patch_error), options);
  const double cpu_s = cpu_now_s() - start_s;
  PlanScore score = score_plan(plan, place_in_world(map, islands.patches[0], run), scenario.plan, run);
  score.plan_cpu_s = cpu_s;
  return score;
}

}  // namespace isthmus
