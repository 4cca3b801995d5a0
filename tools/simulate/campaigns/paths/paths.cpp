#include "tools/simulate/campaigns/paths/paths.hpp"

#include <algorithm>
#include <cmath>
#include <ctime>
#include <optional>

#include "server/engine/engine.hpp"
#include "server/output/pictures/map_sheet.hpp"
#include "server/output/pictures/marks.hpp"
#include "server/output/tables/islands.hpp"
#include "server/paths/questions/frontiers.hpp"
#include "server/paths/questions/relative_pose.hpp"
#include "tools/simulate/campaigns/paths/grid_optimum.hpp"
#include "tools/simulate/plan/random.hpp"
#include "tools/simulate/run/cpu_clock.hpp"
#include "tools/simulate/truth/true_patches.hpp"

namespace isthmus {
namespace {

constexpr std::size_t goals_of_a_start = 25;
constexpr std::size_t drawn_paths = 8;
constexpr double asked_ratio = 1.05;

/// Frontiers have a colour of their own, which no path has.
WayStyle frontier_style() { return way_style(1); }
WayStyle path_style(std::size_t path) { return way_style(path == 0 ? 0 : path + 1); }

Legend paths_legend() {
  return {way_entry("frontier, and from where it is best seen", frontier_style()),
          way_entry("path", path_style(0)), way_entry("next path, and so on", path_style(1))};
}

/// A path's places in the plane.
std::vector<Eigen::Vector2d> places(const Planner& planner, const Path& path) {
  std::vector<Eigen::Vector2d> found;
  for (const ManifoldPose& pose : path.poses) found.push_back(position(planner.project(pose)));
  return found;
}

template <class Visit>
void sample(const std::vector<Eigen::Vector2d>& places, const Visit& visit) {
  for (std::size_t i = 1; i < places.size(); ++i) {
    const Eigen::Vector2d by = places[i] - places[i - 1];
    const int parts = std::max(1, static_cast<int>(std::ceil(by.norm() / 0.01)));
    for (int part = 0; part <= parts; ++part) visit(places[i - 1] + by * (static_cast<double>(part) / parts));
  }
}

class PathTrial {
 public:
  PathTrial(std::shared_ptr<const MapCopy> map, const Footprint& footprint)
      : footprint_(footprint),
        island_(rank_islands(*map).patches.at(0)),
        grid_(render_island(*map, island_, ground_cell_m)),
        optimum_(grid_, footprint),
        picture_(grid_, {"Paths", "the first from each of some starts, and frontiers"}, paths_legend()) {
    const double begin = cpu_now_ms();
    planner_.update(std::move(map));
    const double kept = cpu_now_ms();
    const IslandId island = planner_.map().graph.island(island_.front());
    roadmap_ = planner_.roadmap(island, footprint);
    score_.keep_ms = kept - begin;
    score_.roadmap_ms = cpu_now_ms() - kept;
  }

  void run(std::size_t pairs, Random& random) {
    for (std::size_t pair = 0; pair < pairs; ++pair) {
      if (pair % goals_of_a_start == 0) {
        start_ = place(random);
        optimum_.start_from(start_);
      }
      const Cell goal = place(random);
      if (std::isfinite(optimum_.length_m(goal))) ask(goal);
    }
  }

  PathScore score() {
    std::sort(times_ms_.begin(), times_ms_.end());
    const std::size_t n = times_ms_.size();
    if (n > 0) {
      score_.p50_ms = times_ms_[n / 2];
      score_.p99_ms = times_ms_[std::min(n - 1, n * 99 / 100)];
      score_.max_ms = times_ms_.back();
    }
    if (judged_ > 0) score_.mean_ratio /= static_cast<double>(judged_);
    return score_;
  }
  /// The first paths from each start, and frontiers as lines from where they are best seen.
  void draw(const std::string& path) {
    Canvas& canvas = picture_.canvas();
    const MapWindow& window = picture_.window();
    canvas.clip(window.box);
    for (const Frontier& frontier : find_frontiers(*roadmap_, -1)) {
      const Ground& ground = roadmap_->ground();
      draw_patch(canvas, window, frontier.middle, frontier_style().colour);
      if (frontier.viewpoint >= 0)
        draw_line({ground.centre(frontier.viewpoint), frontier.middle}, frontier_style());
    }
    for (std::size_t i = 0; i < drawn_.size(); ++i) draw_line(drawn_[i], path_style(i));
    if (score_.too_long > 0) draw_line(worst_way_, path_style(drawn_.size()));
    canvas.unclip();
    picture_.write(path);
  }

 private:
  void draw_line(std::vector<Eigen::Vector2d> map_points, const WayStyle& style) {
    for (Eigen::Vector2d& point : map_points) point = picture_.window().pixels(point);
    picture_.canvas().line(
        map_points,
        {.colour = style.colour, .width_px = way_line_px(picture_.window().em), .dashes = style.dashes});
  }

  Cell place(Random& random) const { return optimum_.room().at(random.index(optimum_.room().size())); }

  std::optional<ManifoldPose> pose_of(const Cell& cell) const {
    const Ground& ground = roadmap_->ground();
    const auto [first, last] = ground.at(cell);
    if (first == last) return std::nullopt;
    const PatchId leader = ground.layer(first).leader;
    const Eigen::Vector2d centre = centre_of(cell);
    const Pose& map_from_patch = planner_.map().poses[static_cast<std::size_t>(leader.value)];
    return ManifoldPose{leader, ominus({centre.x(), centre.y(), 0}, map_from_patch)};
  }

  void ask(const Cell& goal) {
    ++score_.pairs;
    const auto from = pose_of(start_), to = pose_of(goal);
    if (!from || !to) {
      ++score_.missing[Refusal::no_ground];
      return;
    }
    const double begin = cpu_now_ms();
    const Path path = planner_.path({*from, *to, footprint_});
    times_ms_.push_back(cpu_now_ms() - begin);
    if (path.refusal != Refusal::none)
      ++score_.missing[path.refusal];
    else
      judge(path, optimum_.length_m(goal));
  }

  void judge(const Path& path, double optimum_m) {
    const std::vector<Eigen::Vector2d> way = places(planner_, path);
    const double asked_m = footprint_.radius_m + footprint_.clearance_m - 1e-6;
    bool through = false, too_near = false;
    sample(way, [&](const Eigen::Vector2d& point) {
      through = through || optimum_.is_occupied(cell_of(point));
      too_near = too_near || optimum_.is_near_wall(point, asked_m);
    });
    score_.through += through;
    score_.too_near += too_near;
    if (optimum_m >= 1) {  // below, a cell is more than what is asked
      const double ratio = path.length_m / optimum_m;
      ++judged_;
      score_.mean_ratio += ratio;
      if (ratio > score_.worst_ratio) {
        score_.worst_ratio = ratio;
        score_.worst = {way.front(), way.back()};
        worst_way_ = way;
      }
      score_.too_long += ratio > asked_ratio;
    }
    if (score_.pairs % goals_of_a_start == 1 && drawn_.size() < drawn_paths) drawn_.push_back(way);
  }

  Footprint footprint_;
  std::vector<PatchId> island_;
  OccupancyGrid grid_;
  GridOptimum optimum_;
  MapSheet picture_;
  Planner planner_;
  std::shared_ptr<const Roadmap> roadmap_;
  Cell start_;
  PathScore score_;
  std::vector<double> times_ms_;
  std::size_t judged_ = 0;
  std::vector<std::vector<Eigen::Vector2d>> drawn_;
  std::vector<Eigen::Vector2d> worst_way_;
};

MapCopy map_until(const SimulatedRun& run, double until_s) {
  Engine engine;
  const std::int64_t begin = run.events.empty() ? 0 : run.events.front().receive_utime;
  for (const Event& event : run.events) {
    if (1e-6 * static_cast<double>(event.receive_utime - begin) > until_s) break;
    engine.handle(event);
  }
  return engine.copy();
}

}  // namespace

PathScore score_paths(std::shared_ptr<const MapCopy> map, std::size_t pairs, std::uint64_t seed,
                      const Footprint& footprint, const std::string& picture) {
  PathTrial trial(std::move(map), footprint);
  Random random(seed, "paths");
  trial.run(pairs, random);
  if (!picture.empty()) trial.draw(picture);
  return trial.score();
}

DriveScore score_drives(const SimulatedRun& run, const FloorPlan& plan, double until_s, std::size_t pairs,
                        std::uint64_t seed, const Footprint& footprint) {
  const auto map = std::make_shared<const MapCopy>(map_until(run, until_s));
  const auto truth = true_patches(*map, run.truth);
  Planner planner;
  planner.update(map);
  Random random(seed, "drives");
  DriveScore score;
  if (map->patches.empty()) return score;
  for (std::size_t pair = 0; pair < pairs; ++pair) {
    const PatchId a = map->patches[random.index(map->patches.size())]->id;
    const PatchId b = map->patches[random.index(map->patches.size())]->id;
    if (map->graph.island(a) != map->graph.island(b)) continue;
    const Path path = planner.path({{a, {}}, {b, {}}, footprint});
    ++score.paths;
    if (path.refusal != Refusal::none) ++score.missing[path.refusal];
    score.metres += path.length_m;
    bool touches = false;
    std::optional<Eigen::Vector2d> before;
    for (const ManifoldPose& pose : path.poses) {
      const auto& patch = truth[static_cast<std::size_t>(pose.patch.value)];
      if (!patch) continue;
      const Eigen::Vector2d here = patch->world_from_patch * position(pose.patch_from_object);
      touches = touches || clearance_m(plan, before.value_or(here), here) < footprint.radius_m;
      before = here;
    }
    score.touching += touches;
  }
  return score;
}

namespace {

using TruePoses = std::map<std::pair<std::string, std::int64_t>, Pose>;

TruePoses poses_by_stamp(const std::vector<RobotTruth>& truth) {
  TruePoses poses;
  for (const RobotTruth& robot : truth)
    for (const TruePose& pose : robot.poses) poses[{robot.robot, pose.utime}] = pose.world_from_robot;
  return poses;
}

void score_pairs(const MapCopy& map, const std::map<std::string, RobotPose>& robots, const TruePoses& truth,
                 TeammateScore& score) {
  for (const auto& [name, a] : robots) {
    for (const auto& [other, b] : robots) {
      const auto true_a = truth.find({name, a.utime}), true_b = truth.find({other, b.utime});
      if (other <= name || true_a == truth.end() || true_b == truth.end()) continue;
      const RelativePoseAnswer answer = relative_pose(map, {a.pose, a.covariance}, {b.pose, b.covariance});
      if (answer.refusal == Refusal::other_island) continue;
      if (answer.refusal != Refusal::none)
        ++score.unknown;
      else
        score.tally.add(wrapped_difference(answer.a_from_b, ominus(true_b->second, true_a->second)),
                        answer.covariance);
    }
  }
}

}  // namespace

TeammateScore score_teammates(const SimulatedRun& run, double interval_s) {
  const TruePoses truth = poses_by_stamp(run.truth);
  Engine engine;
  std::map<std::string, RobotPose> robots;
  TeammateScore score;
  std::int64_t next = 0;
  for (const Event& event : run.events) {
    for (const RobotPose& pose : engine.handle(event).poses) robots[pose.robot] = pose;
    if (event.receive_utime < next) continue;
    if (next > 0) score_pairs(engine.copy(), robots, truth, score);
    next = event.receive_utime + static_cast<std::int64_t>(1e6 * interval_s);
  }
  return score;
}

}  // namespace isthmus
