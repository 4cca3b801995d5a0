#include "scanmatch/correlative.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numbers>

namespace isthmus {
namespace {

constexpr int max_levels = 5;  // of the pyramid, above the cells: says how fast it is, not what it finds

// How well a beam's end fits each cell, 0 to 255, and for each level the maximum over the 2^level x 2^level
// cells to the upper right: a bound for every shift within that block.
class FitPyramid {
 public:
  FitPyramid(std::span<const Eigen::Vector2d> map, const Pose& centre, double half_extent_m,
             const CorrelativeOptions& options, int levels)
      : cell_m_(options.cell_m),
        origin_(centre.x - half_extent_m, centre.y - half_extent_m),
        size_(static_cast<int>(2 * half_extent_m / options.cell_m) + 1) {
    levels_.emplace_back(static_cast<std::size_t>(size_ * size_), std::uint8_t{0});
    const int blur = static_cast<int>(std::ceil(options.blur_sigmas * options.blur_m / cell_m_));
    for (const Eigen::Vector2d& point : map) stamp(point, blur, options.blur_m);
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
  Search(std::span<const Eigen::Vector2d> map, std::span<const ScanPoint> points, const SearchWindow& window,
         const CorrelativeOptions& options, double min_score)
      : window_(window),
        options_(options),
        min_score_(min_score),
        half_x_(static_cast<int>(std::ceil(window.half_x_m / options.cell_m))),
        half_y_(static_cast<int>(std::ceil(window.half_y_m / options.cell_m))),
        top_(std::clamp(static_cast<int>(std::log2(std::max(half_x_, half_y_) + 1)), 0, max_levels)),
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
    search_yaws();
    result.exhausted = exhausted_;
    result.evaluations = evaluations_;
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
      if (answer.score / unit <= result.second_score) continue;
      result.second_score = answer.score / unit;
      result.second_local_from_robot = pose_of(answer);
    }
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

  // A block of shifts at one yaw.
  struct Block {
    double yaw_offset = 0;
    Shift shift;
  };

  // The most promising blocks of all yaws first: what they hold prunes the others. Equal ones from the middle
  // outwards.
  void search_yaws() {
    best_score_ =
        static_cast<int>(min_score_ / options_.second_share * 255.0 * static_cast<double>(beams_.size()));
    const int half_yaw = static_cast<int>(std::ceil(window_.half_yaw_rad / options_.yaw_step_rad));
    std::vector<Block> blocks;
    for (int k = 0; k <= 2 * half_yaw && !exhausted_; ++k) {
      const double yaw_offset = (k % 2 == 1 ? 1 : -1) * ((k + 1) / 2) * options_.yaw_step_rad;
      if (std::abs(yaw_offset) > std::numbers::pi + options_.yaw_step_rad / 2) break;
      turn_to(yaw_offset);
      const int width = 1 << top_;
      for (int y = -half_y_; y <= half_y_; y += width)
        for (int x = -half_x_; x <= half_x_; x += width)
          blocks.push_back({yaw_offset, evaluated(top_, x, y)});
    }
    std::stable_sort(blocks.begin(), blocks.end(),
                     [](const Block& a, const Block& b) { return a.shift.score > b.shift.score; });
    for (const Block& block : blocks) {
      if (exhausted_ || block.shift.score <= options_.second_share * best_score_) return;
      turn_to(block.yaw_offset);
      std::vector<Shift> nodes{block.shift};
      descend(top_, nodes, block.yaw_offset);
    }
  }

  void turn_to(double yaw_offset) {
    cells_.clear();
    const double c = std::cos(window_.centre.yaw + yaw_offset);
    const double s = std::sin(window_.centre.yaw + yaw_offset);
    for (const Eigen::Vector2d& beam : beams_) {
      const Eigen::Vector2d end(c * beam.x() - s * beam.y(), s * beam.x() + c * beam.y());
      cells_.push_back(
          {pyramid_.cell_x(window_.centre.x + end.x()), pyramid_.cell_y(window_.centre.y + end.y()), 0});
    }
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
  double min_score_;
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
  std::vector<Eigen::Vector2d> local_points;
  for (const LocalPatch& local : local_map.patches)
    for (const ScanPoint& point : local.patch->points)
      local_points.push_back(local.local_from_patch * point.position);
  return Search(local_points, points, window, options, 0).run();
}

CorrelativeResult search_window(std::span<const Eigen::Vector2d> local_points,
                                std::span<const ScanPoint> points, const SearchWindow& window,
                                const CorrelativeOptions& options, double min_score) {
  return Search(local_points, points, window, options, min_score).run();
}

}  // namespace isthmus
