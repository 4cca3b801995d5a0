#include "scanmatch/correlative.hpp"

#include <algorithm>
#include <boost/container/static_vector.hpp>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <numbers>

#include "scanmatch/fit_pyramid.hpp"

namespace isthmus {
namespace {

constexpr int max_levels = 5;  // of the pyramid, above the cells: says how fast it is, not what it finds

// Beams end no farther out, wherever in the window the robot is.
Eigen::Vector2d corner(const SearchWindow& window, double side, double reach_m) {
  const double half_m = reach_m + std::max(window.half_x_m, window.half_y_m);
  return {window.centre.x + side * half_m, window.centre.y + side * half_m};
}

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
        beams_(searched_beams(points, options)),
        reach_m_(reach_of(beams_, options)),
        pyramid_(map, corner(window, -1, reach_m_), corner(window, 1, reach_m_), options, top_) {}

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

  // The cells that the beams end in, at one yaw and without a shift.
  struct Turned {
    double yaw_offset = 0;
    std::vector<std::ptrdiff_t> cells;
  };

  // A block of shifts at one yaw.
  struct Block {
    std::size_t turned = 0;
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
      const int outwards = (k + 1) / 2;
      const double yaw_offset = (k % 2 == 1 ? 1 : -1) * outwards * options_.yaw_step_rad;
      if (std::abs(yaw_offset) > std::numbers::pi + options_.yaw_step_rad / 2) break;
      turned_.push_back(turned(yaw_offset));
      const int width = 1 << top_;
      for (int y = -half_y_; y <= half_y_; y += width)
        for (int x = -half_x_; x <= half_x_; x += width)
          blocks.push_back({turned_.size() - 1, evaluated(turned_.back(), top_, x, y)});
    }
    std::stable_sort(blocks.begin(), blocks.end(),
                     [](const Block& a, const Block& b) { return a.shift.score > b.shift.score; });
    for (const Block& block : blocks) {
      if (exhausted_ || block.shift.score <= options_.second_share * best_score_) return;
      descend(turned_[block.turned], top_, {block.shift});
    }
  }

  Turned turned(double yaw_offset) const {
    Turned made{yaw_offset, {}};
    made.cells.reserve(beams_.size());
    const double c = std::cos(window_.centre.yaw + yaw_offset);
    const double s = std::sin(window_.centre.yaw + yaw_offset);
    for (const Eigen::Vector2d& beam : beams_)
      made.cells.push_back(pyramid_.cell({window_.centre.x + (c * beam.x() - s * beam.y()),
                                          window_.centre.y + (s * beam.x() + c * beam.y())}));
    return made;
  }

  Shift evaluated(const Turned& turned, int level, int x, int y) {
    ++evaluations_;
    if (evaluations_ > options_.max_evaluations) exhausted_ = true;
    int score = 0;
    const std::uint8_t* fits = pyramid_.level(level) + pyramid_.step(x, y);
    for (const std::ptrdiff_t cell : turned.cells) score += fits[cell];
    return {x, y, score};
  }

  // Best first; of equal ones, that which came first.
  using BestFirst = boost::container::static_vector<Shift, 4>;
  static void insert(BestFirst& shifts, const Shift& shift) {
    const auto worse = [](const Shift& a, const Shift& b) { return a.score > b.score; };
    shifts.insert(std::upper_bound(shifts.begin(), shifts.end(), shift, worse), shift);
  }

  void descend(const Turned& turned, int level, const BestFirst& nodes) {
    for (const Shift& node : nodes) {
      if (exhausted_ || node.score <= options_.second_share * best_score_) return;
      if (level == 0) {
        answers_.push_back({node.x, node.y, turned.yaw_offset, node.score});
        best_score_ = std::max(best_score_, node.score);
        continue;
      }
      BestFirst children;
      const int half = 1 << (level - 1);
      for (const int dy : {0, half}) {
        for (const int dx : {0, half}) {
          if (node.x + dx <= half_x_ && node.y + dy <= half_y_)
            insert(children, evaluated(turned, level - 1, node.x + dx, node.y + dy));
        }
      }
      descend(turned, level - 1, children);
    }
  }

  const SearchWindow& window_;
  const CorrelativeOptions& options_;
  double min_score_;
  int half_x_;
  int half_y_;
  int top_;
  std::vector<Eigen::Vector2d> beams_;
  double reach_m_;
  FitPyramid pyramid_;
  std::vector<Turned> turned_;
  std::vector<Answer> answers_;
  int best_score_ = 0;
  long evaluations_ = 0;
  bool exhausted_ = false;
};

}  // namespace

std::vector<Eigen::Vector2d> searched_beams(std::span<const ScanPoint> points,
                                            const CorrelativeOptions& options) {
  std::vector<Eigen::Vector2d> beams;
  const std::size_t stride =
      std::max<std::size_t>(1, points.size() / static_cast<std::size_t>(options.max_points));
  for (std::size_t i = stride / 2; i < points.size(); i += stride)
    if (points[i].position.norm() <= options.reach_m) beams.push_back(points[i].position);
  return beams;
}

double reach_of(std::span<const Eigen::Vector2d> beams, const CorrelativeOptions& options) {
  double squared = 0;
  for (const Eigen::Vector2d& beam : beams) squared = std::max(squared, beam.squaredNorm());
  return options.cell_m * std::ceil(std::sqrt(squared) / options.cell_m);
}

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
