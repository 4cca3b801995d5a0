#include "server/output/vector_plan/sight_lines.hpp"

#include <cmath>
#include <optional>

#include "server/output/vector_plan/line_grid.hpp"

namespace isthmus {
namespace {

/// Where along the line a beam goes through it; nothing where it does not.
std::optional<double> passes_at(const WallLine& line, const Eigen::Vector2d& eye, const Eigen::Vector2d& end,
                                const StretchOptions& options) {
  const double before = line.across_m(eye), behind = line.across_m(end);
  if (before * behind >= 0 || std::abs(behind) < options.pass_m) return std::nullopt;
  if (std::abs(behind - before) < options.min_incidence * (end - eye).norm()) return std::nullopt;
  const double share = before / (before - behind);
  return line.along_m(eye + share * (end - eye));
}

class Passes {
 public:
  Passes(std::span<const WallLine> lines, const StretchOptions& options) : lines_(lines), options_(options) {
    for (std::size_t i = 0; i < lines.size(); ++i) {
      grid_.insert(static_cast<int>(i), lines[i].at(-lines[i].half_m), lines[i].at(lines[i].half_m));
      counts_.emplace_back(bin_count(lines[i], options), 0);
      last_view_.emplace_back(bin_count(lines[i], options), -1);
    }
  }

  void add(const View& view, int number) {
    for (const Eigen::Vector2d& end : view.ends)
      for (const int line : grid_.near(view.eye, end)) add(static_cast<std::size_t>(line), view, end, number);
  }

  std::vector<std::vector<int>> counts() { return std::move(counts_); }

 private:
  void add(std::size_t line, const View& view, const Eigen::Vector2d& end, int number) {
    const std::optional<double> at = passes_at(lines_[line], view.eye, end, options_);
    if (!at) return;
    const double bin = std::floor((*at + lines_[line].half_m) / options_.bin_m);
    if (bin < 0 || bin >= static_cast<double>(counts_[line].size())) return;
    const auto k = static_cast<std::size_t>(bin);
    if (last_view_[line][k] == number) return;
    last_view_[line][k] = number;
    ++counts_[line][k];
  }

  std::span<const WallLine> lines_;
  const StretchOptions& options_;
  LineGrid grid_;
  std::vector<std::vector<int>> counts_;
  std::vector<std::vector<int>> last_view_;  ///< that was counted, by bin
};

}  // namespace

std::size_t bin_count(const WallLine& line, const StretchOptions& options) {
  return static_cast<std::size_t>(std::ceil(2 * line.half_m / options.bin_m)) + 1;
}

std::vector<std::vector<int>> count_passes(std::span<const WallLine> lines, std::span<const View> views,
                                           const StretchOptions& options) {
  Passes passes(lines, options);
  for (std::size_t i = 0; i < views.size(); ++i) passes.add(views[i], static_cast<int>(i));
  return passes.counts();
}

}  // namespace isthmus
