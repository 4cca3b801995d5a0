#include "scanmatch/fit_pyramid.hpp"

#include <algorithm>
#include <cmath>

namespace isthmus {

FitPyramid::FitPyramid(std::span<const Eigen::Vector2d> map, const Eigen::Vector2d& low,
                       const Eigen::Vector2d& high, const CorrelativeOptions& options, int levels)
    : cell_m_(options.cell_m),
      margin_(1 << levels),
      origin_(low),
      columns_(static_cast<int>((high.x() - low.x()) / options.cell_m) + 1),
      rows_(static_cast<int>((high.y() - low.y()) / options.cell_m) + 1),
      width_(columns_ + 2 * margin_) {
  levels_.emplace_back(static_cast<std::size_t>(width_) * static_cast<std::size_t>(rows_ + 2 * margin_),
                       std::uint8_t{0});
  const int blur = static_cast<int>(std::ceil(options.blur_sigmas * options.blur_m / cell_m_));
  for (const Eigen::Vector2d& point : map) stamp(point, blur, options.blur_m);
  for (int level = 1; level <= levels; ++level) levels_.push_back(widened(levels_.back(), 1 << (level - 1)));
}

void FitPyramid::stamp(const Eigen::Vector2d& position, int blur, double blur_m) {
  const int cx = cell_x(position.x());
  const int cy = cell_y(position.y());
  const auto fall = [&](int cell, double origin, double at) {
    const double d = origin + (cell + 0.5) * cell_m_ - at;
    return std::exp(-0.5 * d * d / (blur_m * blur_m));
  };
  const int left = std::max(0, cx - blur);
  const int right = std::min(columns_ - 1, cx + blur);
  falls_x_.clear();
  for (int x = left; x <= right; ++x) falls_x_.push_back(fall(x, origin_.x(), position.x()));
  for (int y = std::max(0, cy - blur); y <= std::min(rows_ - 1, cy + blur); ++y) {
    const double fall_y = fall(y, origin_.y(), position.y());
    std::uint8_t* row = levels_[0].data() + index(left, y);
    for (const double fall_x : falls_x_) {
      *row = std::max(*row, static_cast<std::uint8_t>(255 * (fall_x * fall_y)));
      ++row;
    }
  }
}

// The maximum with what lies `shift` to the right, then with what lies `shift` above.
std::vector<std::uint8_t> FitPyramid::widened(const std::vector<std::uint8_t>& below, int shift) const {
  std::vector<std::uint8_t> level = below;
  const auto right = static_cast<std::size_t>(shift);
  for (std::size_t i = 0; i + right < level.size(); ++i) level[i] = std::max(below[i], below[i + right]);
  const std::size_t up = right * static_cast<std::size_t>(width_);
  for (std::size_t i = 0; i + up < level.size(); ++i) level[i] = std::max(level[i], level[i + up]);
  return level;
}

}  // namespace isthmus
