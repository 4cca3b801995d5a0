#include "scanmatch/correlative.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>

namespace isthmus {
namespace {

// How well a beam's end fits each cell, 0 to 255, and for each level the maximum over the 2^level x 2^level
// cells to the upper right: a bound for every shift within that block.
class FitPyramid {
 public:
  FitPyramid(const LocalMap& map, const Pose& centre, double half_extent_m, const CorrelativeOptions& options,
             int levels)
      : cell_m_(options.cell_m),
        origin_(centre.x - half_extent_m, centre.y - half_extent_m),
        size_(static_cast<int>(2 * half_extent_m / options.cell_m) + 1) {
    levels_.emplace_back(static_cast<std::size_t>(size_ * size_), std::uint8_t{0});
    const int blur = static_cast<int>(std::ceil(2.5 * options.blur_m / cell_m_));
    for (const LocalPatch& local : map.patches) {
      for (const ScanPoint& point : local.patch->points)
        stamp(local.local_from_patch * point.position, blur, options.blur_m);
    }
    for (int level = 1; level <= levels; ++level) levels_.push_back(widen(levels_.back(), 1 << (level - 1)));
  }

  int cell_x(double x) const { return static_cast<int>(std::floor((x - origin_.x()) / cell_m_)); }
  int cell_y(double y) const { return static_cast<int>(std::floor((y - origin_.y()) / cell_m_)); }

  int fit(int level, int x, int y) const {
    // Blocks that begin left of the grid may still reach into it.
    const int width = 1 << level;
    if (x >= size_ || y >= size_ || x + width <= 0 || y + width <= 0) return 0;
    x = std::max(x, 0);
    y = std::max(y, 0);
    return levels_[static_cast<std::size_t>(level)][static_cast<std::size_t>(y * size_ + x)];
  }

 private:
  void stamp(const Eigen::Vector2d& position, int blur, double blur_m) {
    const int cx = cell_x(position.x());
    const int cy = cell_y(position.y());
    for (int y = std::max(0, cy - blur); y <= std::min(size_ - 1, cy + blur); ++y) {
      for (int x = std::max(0, cx - blur); x <= std::min(size_ - 1, cx + blur); ++x) {
        const double dx = origin_.x() + (x + 0.5) * cell_m_ - position.x();
        const double dy = origin_.y() + (y + 0.5) * cell_m_ - position.y();
        const double fit = std::exp(-0.5 * (dx * dx + dy * dy) / (blur_m * blur_m));
        std::uint8_t& cell = levels_[0][static_cast<std::size_t>(y * size_ + x)];
        cell = std::max(cell, static_cast<std::uint8_t>(255 * fit));
      }
    }
  }

  std::vector<std::uint8_t> widen(const std::vector<std::uint8_t>& below, int shift) const {
    std::vector<std::uint8_t> level(below.size());
    for (int y = 0; y < size_; ++y) {
      for (int x = 0; x < size_; ++x) {
        std::uint8_t best = 0;
        for (const int dy : {0, shift}) {
          for (const int dx : {0, shift}) {
            if (x + dx < size_ && y + dy < size_)
              best = std::max(best, below[static_cast<std::size_t>((y + dy) * size_ + x + dx)]);
          }
        }
        level[static_cast<std::size_t>(y * size_ + x)] = best;
      }
    }
    return level;
  }

  double cell_m_;
  Eigen::Vector2d origin_;
  int size_;
  std::vector<std::vector<std::uint8_t>> levels_;
};

struct Shift {
  int x = 0;
  int y = 0;
  int score = 0;  // sum of fits over the beams
};

class Search {
 public:
  Search(const LocalMap& map, std::span<const ScanPoint> points, const SearchWindow& window,
         const CorrelativeOptions& options)
      : window_(window),
        options_(options),
        half_x_(static_cast<int>(std::ceil(window.half_x_m / options.cell_m))),
        half_y_(static_cast<int>(std::ceil(window.half_y_m / options.cell_m))),
        top_(std::clamp(static_cast<int>(std::log2(std::max(half_x_, half_y_) + 1)), 0, 5)),
        pyramid_(map, window.centre, options.reach_m + std::max(window.half_x_m, window.half_y_m), options,
                 top_) {
    const std::size_t stride =
        std::max<std::size_t>(1, points.size() / static_cast<std::size_t>(options.max_points));
    for (std::size_t i = stride / 2; i < points.size(); i += stride) {
      if (points[i].position.norm() <= options.reach_m) beams_.push_back(points[i].position);
    }
  }

  CorrelativeResult run() {
    CorrelativeResult result;
    result.local_from_robot = window_.centre;
    if (beams_.empty()) return result;
    const int half_yaw = static_cast<int>(std::ceil(window_.half_yaw_rad / options_.yaw_step_rad));
    // From the middle outwards: the best is likely near the prediction and prunes the rest.
    for (int k = 0; k <= 2 * half_yaw && !exhausted_; ++k) {
      const int step = (k % 2 == 1 ? 1 : -1) * ((k + 1) / 2);
      search_yaw(step * options_.yaw_step_rad);
    }
    if (answers_.empty()) return result;
    const auto best = std::max_element(answers_.begin(), answers_.end(),
                                       [](const Answer& a, const Answer& b) { return a.score < b.score; });
    const double unit = 255.0 * static_cast<double>(beams_.size());
    result.local_from_robot = pose_of(*best);
    result.score = best->score / unit;
    for (const Answer& answer : answers_) {
      const Pose apart = ominus(pose_of(answer), pose_of(*best));
      if (std::hypot(apart.x, apart.y) < options_.apart_m && std::abs(apart.yaw) < options_.apart_rad)
        continue;
      result.second_score = std::max(result.second_score, answer.score / unit);
    }
    result.exhausted = exhausted_;
    return result;
  }

 private:
  struct Answer {
    int x = 0;
    int y = 0;
    double yaw_offset = 0;
    int score = 0;
  };

  Pose pose_of(const Answer& answer) const {
    return {window_.centre.x + answer.x * options_.cell_m, window_.centre.y + answer.y * options_.cell_m,
            wrap_angle(window_.centre.yaw + answer.yaw_offset)};
  }

  void search_yaw(double yaw_offset) {
    cells_.clear();
    for (const Eigen::Vector2d& beam : beams_) {
      const Eigen::Vector2d end = rotate(window_.centre.yaw + yaw_offset, beam);
      cells_.push_back(
          {pyramid_.cell_x(window_.centre.x + end.x()), pyramid_.cell_y(window_.centre.y + end.y()), 0});
    }
    std::vector<Shift> nodes;
    const int width = 1 << top_;
    for (int y = -half_y_; y <= half_y_; y += width) {
      for (int x = -half_x_; x <= half_x_; x += width) nodes.push_back(evaluated(top_, x, y));
    }
    descend(top_, nodes, yaw_offset);
  }

  Shift evaluated(int level, int x, int y) {
    ++evaluations_;
    if (evaluations_ > options_.max_evaluations) exhausted_ = true;
    int score = 0;
    for (const Shift& cell : cells_) score += pyramid_.fit(level, cell.x + x, cell.y + y);
    return {x, y, score};
  }

  void descend(int level, std::vector<Shift>& nodes, double yaw_offset) {
    std::stable_sort(nodes.begin(), nodes.end(),
                     [](const Shift& a, const Shift& b) { return a.score > b.score; });
    for (const Shift& node : nodes) {
      if (exhausted_ || node.score <= options_.second_share * best_score_) return;
      if (level == 0) {
        answers_.push_back({node.x, node.y, yaw_offset, node.score});
        best_score_ = std::max(best_score_, node.score);
        continue;
      }
      std::vector<Shift> children;
      const int half = 1 << (level - 1);
      for (const int dy : {0, half}) {
        for (const int dx : {0, half}) {
          if (node.x + dx <= half_x_ && node.y + dy <= half_y_)
            children.push_back(evaluated(level - 1, node.x + dx, node.y + dy));
        }
      }
      descend(level - 1, children, yaw_offset);
    }
  }

  const SearchWindow& window_;
  const CorrelativeOptions& options_;
  int half_x_;
  int half_y_;
  int top_;
  FitPyramid pyramid_;
  std::vector<Eigen::Vector2d> beams_;
  std::vector<Shift> cells_;
  std::vector<Answer> answers_;
  int best_score_ = 0;
  long evaluations_ = 0;
  bool exhausted_ = false;
};

}  // namespace

CorrelativeResult search_window(const LocalMap& local_map, std::span<const ScanPoint> points,
                                const SearchWindow& window, const CorrelativeOptions& options) {
  return Search(local_map, points, window, options).run();
}

}  // namespace isthmus
