#include "scanmatch/fit_pyramid.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>

namespace isthmus {
namespace {

// Each of the first cells becomes the larger of itself and the other; the others may lie further on among
// the same cells. So many at once that a compiler does them as vectors.
void take_larger(std::span<std::uint8_t> cells, std::span<const std::uint8_t> others) {
  constexpr std::size_t at_once = 64;
  std::size_t i = 0;
  for (; i + at_once <= others.size(); i += at_once) {
    std::array<std::uint8_t, at_once> mine, theirs;
    std::memcpy(mine.data(), &cells[i], at_once);
    std::memcpy(theirs.data(), &others[i], at_once);
    for (std::size_t k = 0; k < at_once; ++k) mine[k] = std::max(mine[k], theirs[k]);
    std::memcpy(&cells[i], mine.data(), at_once);
  }
  for (; i < others.size(); ++i) cells[i] = std::max(cells[i], others[i]);
}

}  // namespace

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

// The maximum of each cell and those `shift` to the right, above, and both.
std::vector<std::uint8_t> FitPyramid::widened(const std::vector<std::uint8_t>& below, int shift) const {
  std::vector<std::uint8_t> level = below;
  const auto right = static_cast<std::size_t>(shift);
  take_larger(level, std::span(below).subspan(right));
  const std::size_t up = right * static_cast<std::size_t>(width_);
  take_larger(level, std::span(level).subspan(up));
  return level;
}

}  // namespace isthmus
