#include "tools/simulate/run/traffic.hpp"

#include <algorithm>
#include <bitset>
#include <cmath>
#include <map>
#include <optional>
#include <utility>

namespace isthmus {
namespace {

constexpr std::size_t steps_in_tick = 10;
constexpr double tick_s = steps_in_tick * TruePath::step_s;
constexpr std::size_t max_delay = 1000;  // ticks
constexpr double min_gap_m = 0.1;        // between two robots' hulls
constexpr double cell_m = 1;

using Delays = std::bitset<max_delay + 1>;
using Cell = std::pair<int, int>;

Cell cell_of(const Pose& pose, int right = 0, int up = 0) {
  return {static_cast<int>(std::floor(pose.x / cell_m)) + right,
          static_cast<int>(std::floor(pose.y / cell_m)) + up};
}

// Finds when a robot goes how far: at tick t of its time it has driven t - d ticks of its path, and its delay
// d stays as it is or grows by one. All delays that can be had without touching anybody are followed at once.
class Timetable {
 public:
  Timetable(const std::vector<TruePath>& paths, const std::vector<double>& radii_m, std::size_t robot)
      : paths_(paths), radii_m_(radii_m), robot_(robot), start_s_(paths[robot].stretches()[0].start_s) {
    double end_s = paths[robot].end_s();
    for (std::size_t other = 0; other < robot; ++other) end_s = std::max(end_s, paths[other].end_s());
    ticks_ = static_cast<std::size_t>((end_s - start_s_) / tick_s) + max_delay + 2;
    for (std::size_t tick = 0; tick <= ticks_; ++tick) {
      way_.push_back(*paths[robot].at(start_s_ + static_cast<double>(tick) * tick_s));
      ticks_in_[cell_of(way_.back())].push_back(tick);
    }
  }

  // The delay at each tick.
  std::optional<std::vector<std::size_t>> delays() const {
    std::vector<Delays> possible(1);
    possible[0].set(0);
    for (std::size_t tick = 1; tick < ticks_; ++tick) {
      const Delays& before = possible.back();
      possible.push_back((before | before << 1) & ~touching(tick));
      if (possible.back().none()) return std::nullopt;
    }
    std::vector<std::size_t> delays(ticks_);
    std::size_t delay = 0;
    while (!possible.back().test(delay)) ++delay;
    for (std::size_t tick = ticks_; tick-- > 0;) {
      if (!possible[tick].test(delay)) --delay;
      delays[tick] = delay;
    }
    return delays;
  }

 private:
  Delays touching(std::size_t tick) const {
    Delays delays;
    for (std::size_t other = 0; other < robot_; ++other) {
      const auto pose = paths_[other].at(start_s_ + static_cast<double>(tick) * tick_s);
      if (!pose) continue;
      const double min_m = radii_m_[robot_] + radii_m_[other] + min_gap_m;
      for (const auto& [right, up] :
           {Cell{-1, -1}, {0, -1}, {1, -1}, {-1, 0}, {0, 0}, {1, 0}, {-1, 1}, {0, 1}, {1, 1}}) {
        const auto near = ticks_in_.find(cell_of(*pose, right, up));
        if (near == ticks_in_.end()) continue;
        for (const std::size_t driven : near->second) {
          if (driven > tick || tick - driven > max_delay) continue;
          if (std::hypot(way_[driven].x - pose->x, way_[driven].y - pose->y) < min_m)
            delays.set(tick - driven);
        }
      }
    }
    return delays;
  }

  const std::vector<TruePath>& paths_;
  const std::vector<double>& radii_m_;
  std::size_t robot_;
  double start_s_;
  std::size_t ticks_ = 0;
  std::vector<Pose> way_;
  std::map<Cell, std::vector<std::size_t>> ticks_in_;
};

TruePath delayed(const TruePath& path, const std::vector<std::size_t>& delays) {
  const std::vector<Pose>& poses = path.stretches()[0].world_from_robot;
  PathStretch stretch = path.stretches()[0];
  stretch.world_from_robot.clear();
  for (std::size_t tick = 0; tick + 1 < delays.size(); ++tick) {
    const bool waits = delays[tick + 1] > delays[tick];
    for (std::size_t step = 0; step < steps_in_tick; ++step) {
      const std::size_t driven = (tick - delays[tick]) * steps_in_tick + (waits ? 0 : step);
      if (driven + 1 >= poses.size()) break;
      stretch.world_from_robot.push_back(poses[driven]);
    }
  }
  stretch.world_from_robot.push_back(poses.back());
  return TruePath({std::move(stretch)});
}

}  // namespace

void give_way(std::vector<TruePath>& paths, const std::vector<double>& radii_m) {
  for (std::size_t robot = 1; robot < paths.size(); ++robot) {
    if (paths[robot].stretches().size() > 1) continue;
    if (const auto delays = Timetable(paths, radii_m, robot).delays())
      paths[robot] = delayed(paths[robot], *delays);
  }
}

}  // namespace isthmus
