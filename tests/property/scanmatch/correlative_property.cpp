#include <gtest/gtest.h>

#include <cmath>
#include <map>

#include "scanmatch/correlative.hpp"
#include "tests/property/drawn.hpp"

namespace isthmus {
namespace {

using testing::between;

/// A map of points, the beams' ends of a robot in it, and where to look for it.
struct Scene {
  std::vector<Eigen::Vector2d> map;
  std::vector<ScanPoint> points;
  SearchWindow window;
  CorrelativeOptions options;
};

Scene random_scene() {
  Scene scene;
  scene.options.reach_m = between(0.8, 2);
  scene.options.yaw_step_rad = between(0.05, 0.2);
  scene.options.max_evaluations = 100'000'000;
  scene.window = {{between(-3, 3), between(-3, 3), between(-3, 3)},
                  between(0.05, 0.9),
                  between(0.05, 0.9),
                  between(0, 0.5)};
  const Pose truth = scene.window.centre * Pose{between(-1, 1) * scene.window.half_x_m,
                                                between(-1, 1) * scene.window.half_y_m,
                                                between(-1, 1) * scene.window.half_yaw_rad};
  const int beams = *rc::gen::inRange(1, 25);
  for (int i = 0; i < beams; ++i) {
    // Some at the very reach: their cells are those at the edge of the search's grid.
    const double range =
        *rc::gen::inRange(0, 2) == 0 ? scene.options.reach_m : between(0.1, 1.1) * scene.options.reach_m;
    const Eigen::Vector2d end = rotate(between(-3.2, 3.2), {range, 0});
    scene.points.push_back({end, Eigen::Vector2d::Zero()});
    if (*rc::gen::inRange(0, 4) > 0)
      scene.map.push_back(truth * end + Eigen::Vector2d(between(-0.1, 0.1), between(-0.1, 0.1)));
  }
  const int others = *rc::gen::inRange(0, 20);
  for (int i = 0; i < others; ++i)
    scene.map.push_back(scene.window.centre * Eigen::Vector2d(between(-2.5, 2.5), between(-2.5, 2.5)));
  return scene;
}

/// Of those in reach, in whole cells.
double longest_beam_m(const Scene& scene) {
  double longest = 0;
  for (const ScanPoint& point : scene.points)
    if (point.position.norm() <= scene.options.reach_m) longest = std::max(longest, point.position.norm());
  return scene.options.cell_m * std::ceil(longest / scene.options.cell_m);
}

/// The same search by trying every pose of the window.
class EveryPose {
 public:
  explicit EveryPose(const Scene& scene)
      : scene_(scene),
        half_extent_m_(longest_beam_m(scene) + std::max(scene.window.half_x_m, scene.window.half_y_m)) {
    const double cell_m = scene.options.cell_m;
    size_ = static_cast<int>(2 * half_extent_m_ / cell_m) + 1;
    const int blur = static_cast<int>(std::ceil(2.5 * scene.options.blur_m / cell_m));
    for (const Eigen::Vector2d& point : scene.map) {
      const auto [cx, cy] = cell(point);
      for (int x = cx - blur; x <= cx + blur; ++x) {
        for (int y = cy - blur; y <= cy + blur; ++y) {
          const Eigen::Vector2d centre = origin() + cell_m * Eigen::Vector2d(x + 0.5, y + 0.5);
          const double fit =
              std::exp(-0.5 * (centre - point).squaredNorm() / std::pow(scene.options.blur_m, 2));
          int& best = fit_[{x, y}];
          best = std::max(best, static_cast<int>(255 * fit + 1e-9));
        }
      }
    }
    for (const ScanPoint& point : scene.points)
      if (point.position.norm() <= scene.options.reach_m) beams_.push_back(point.position);
  }

  struct Tried {
    Pose pose;
    double score = 0;
  };
  std::vector<Tried> all() const {
    std::vector<Tried> tried;
    const auto steps = [](double half, double step) { return static_cast<int>(std::ceil(half / step)); };
    const int half_x = steps(scene_.window.half_x_m, scene_.options.cell_m);
    const int half_y = steps(scene_.window.half_y_m, scene_.options.cell_m);
    const int half_yaw = steps(scene_.window.half_yaw_rad, scene_.options.yaw_step_rad);
    for (int k = -half_yaw; k <= half_yaw; ++k)
      for (int x = -half_x; x <= half_x; ++x)
        for (int y = -half_y; y <= half_y; ++y) tried.push_back(at(x, y, k * scene_.options.yaw_step_rad));
    return tried;
  }
  std::size_t beams() const { return beams_.size(); }

 private:
  Eigen::Vector2d origin() const {
    return {scene_.window.centre.x - half_extent_m_, scene_.window.centre.y - half_extent_m_};
  }
  std::pair<int, int> cell(const Eigen::Vector2d& position) const {
    const Eigen::Vector2d at = (position - origin()) / scene_.options.cell_m;
    return {static_cast<int>(std::floor(at.x())), static_cast<int>(std::floor(at.y()))};
  }
  Tried at(int x, int y, double yaw_offset) const {
    const Pose& centre = scene_.window.centre;
    int sum = 0;
    for (const Eigen::Vector2d& beam : beams_) {
      const auto [cx, cy] = cell(Eigen::Vector2d(centre.x, centre.y) + rotate(centre.yaw + yaw_offset, beam));
      const bool inside = cx + x >= 0 && cy + y >= 0 && cx + x < size_ && cy + y < size_;
      const auto found = fit_.find({cx + x, cy + y});
      if (inside && found != fit_.end()) sum += found->second;
    }
    return {{centre.x + x * scene_.options.cell_m, centre.y + y * scene_.options.cell_m,
             wrap_angle(centre.yaw + yaw_offset)},
            beams_.empty() ? 0 : sum / (255.0 * static_cast<double>(beams_.size()))};
  }

  const Scene& scene_;
  double half_extent_m_;
  int size_ = 0;
  std::map<std::pair<int, int>, int> fit_;
  std::vector<Eigen::Vector2d> beams_;
};

bool apart(const Pose& a, const Pose& b, const CorrelativeOptions& options) {
  const Pose off = ominus(a, b);
  return std::hypot(off.x, off.y) >= options.apart_m || std::abs(off.yaw) >= options.apart_rad;
}

TEST(SearchWindowProperty, FindsThePoseThatTryingEveryPoseFinds) {
  EXPECT_TRUE(rc::check([] {
    const Scene scene = random_scene();
    const EveryPose every(scene);
    const std::vector<EveryPose::Tried> tried = every.all();
    const CorrelativeResult found = search_window(scene.map, scene.points, scene.window, scene.options);
    RC_ASSERT(!found.exhausted);
    double best = 0;
    for (const EveryPose::Tried& one : tried) best = std::max(best, one.score);
    RC_ASSERT(std::abs(found.score - best) < 1e-9);
    if (best <= 0) return;
    double its_score = -1, second = 0;
    for (const EveryPose::Tried& one : tried) {
      if ((to_vector(one.pose) - to_vector(found.local_from_robot)).norm() < 1e-6) its_score = one.score;
      if (apart(one.pose, found.local_from_robot, scene.options)) second = std::max(second, one.score);
    }
    RC_ASSERT(std::abs(its_score - best) < 1e-9);
    // Answers below a share of the best are not looked for; the others are found, the best of them too.
    if (second > scene.options.second_share * best) RC_ASSERT(std::abs(found.second_score - second) < 1e-9);
    RC_ASSERT(found.second_score <= second + 1e-9);
  }));
}

}  // namespace
}  // namespace isthmus
