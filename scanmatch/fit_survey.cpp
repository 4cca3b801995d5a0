#include "scanmatch/fit_survey.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <numbers>

namespace isthmus {
namespace {

// Beams end so far outside the box of positions, and blocks reach over its edge.
Eigen::Vector2d margin(double side, int block, const CorrelativeOptions& options) {
  return Eigen::Vector2d::Constant(side * (options.reach_m + block * options.cell_m));
}

double beyond(double at, double low, double high) { return std::max({0.0, low - at, at - high}); }

}  // namespace

FitSurvey::FitSurvey(std::span<const Eigen::Vector2d> map, const Eigen::Vector2d& low,
                     const Eigen::Vector2d& high, const CorrelativeOptions& options)
    : low_(low),
      high_(high),
      pyramid_(map, low + margin(-1, block, options), high + margin(1, block, options), options, top),
      top_fits_(pyramid_, top, strip) {}

SurveyedScan::SurveyedScan(const FitSurvey& survey, std::span<const ScanPoint> points, double min_score,
                           const CorrelativeOptions& options)
    : survey_(survey),
      block_m_(FitSurvey::block * options.cell_m),
      beams_(searched_beams(points, options)),
      least_(static_cast<int>(min_score * 255.0 * static_cast<double>(beams_.size()))),
      cell_m_(options.cell_m),
      columns_(static_cast<int>((survey.high_.x() - survey.low_.x()) / block_m_) + 1),
      rows_(static_cast<int>((survey.high_.y() - survey.low_.y()) / block_m_) + 1),
      strips_((columns_ + FitSurvey::strip - 1) / FitSurvey::strip),
      turned_(static_cast<std::size_t>(std::ceil(2 * std::numbers::pi / options.yaw_step_rad))) {}

bool SurveyedScan::may_fit(const Pose& map_from_place, const SearchWindow& window) {
  const double yaw = (map_from_place * window.centre).yaw;
  const std::vector<PartOfStrip> parts = parts_of(map_from_place, window);
  const double step_rad = 2 * std::numbers::pi / static_cast<double>(turned_.size());
  const int middle = static_cast<int>(std::lround(yaw / step_rad));
  const int half_yaw =
      static_cast<int>(std::ceil(std::min(window.half_yaw_rad, std::numbers::pi) / step_rad));
  for (int k = middle - half_yaw; k <= middle + half_yaw; ++k) {
    Turned& at_yaw = turned(k);
    if (std::ranges::any_of(parts, [&](const PartOfStrip& part) { return reaches(at_yaw, part); }))
      return true;
  }
  return false;
}

// The blocks that meet the box of the window and the circle around it.
std::vector<SurveyedScan::PartOfStrip> SurveyedScan::parts_of(const Pose& map_from_place,
                                                              const SearchWindow& window) const {
  const Pose centre = map_from_place * window.centre;
  const double c = std::abs(std::cos(map_from_place.yaw));
  const double s = std::abs(std::sin(map_from_place.yaw));
  // Where a search's steps and these differ by less than a cell.
  const double half_x = c * window.half_x_m + s * window.half_y_m + cell_m_;
  const double half_y = s * window.half_x_m + c * window.half_y_m + cell_m_;
  const double radius = std::hypot(window.half_x_m, window.half_y_m) + cell_m_;
  const auto number = [&](double at, int count) {
    return std::clamp(static_cast<int>(std::floor(at / block_m_)), 0, count - 1);
  };
  const double x = centre.x - survey_.low_.x();
  const double y = centre.y - survey_.low_.y();
  std::vector<PartOfStrip> parts;
  for (int row = number(y - half_y, rows_); row <= number(y + half_y, rows_); ++row) {
    const double off_y = beyond(y, row * block_m_, (row + 1) * block_m_);
    for (int column = number(x - half_x, columns_); column <= number(x + half_x, columns_); ++column) {
      const double off_x = beyond(x, column * block_m_, (column + 1) * block_m_);
      if (std::hypot(off_x, off_y) > radius) continue;
      const int first = column - column % FitSurvey::strip;
      if (parts.empty() || parts.back().row != row || parts.back().first_column != first)
        parts.push_back({row, first, 0});
      parts.back().blocks |= 1U << static_cast<unsigned>(column - first);
    }
  }
  return parts;
}

SurveyedScan::Turned& SurveyedScan::turned(int yaw_step) {
  const int count = static_cast<int>(turned_.size());
  Turned& turned = turned_[static_cast<std::size_t>((yaw_step % count + count) % count)];
  if (!turned.strips.empty()) return turned;
  turned.strips.resize(static_cast<std::size_t>(strips_) * static_cast<std::size_t>(rows_));
  const double yaw = 2 * std::numbers::pi * yaw_step / count;
  const double c = std::cos(yaw);
  const double s = std::sin(yaw);
  turned.cells.reserve(beams_.size());
  turned.of_tops.reserve(beams_.size());
  for (const Eigen::Vector2d& beam : beams_) {
    turned.cells.push_back(survey_.pyramid_.cell(
        survey_.low_ + Eigen::Vector2d(c * beam.x() - s * beam.y(), s * beam.x() + c * beam.y())));
    turned.of_tops.push_back(survey_.top_fits_.index(turned.cells.back()));
  }
  return turned;
}

bool SurveyedScan::reaches(Turned& turned, const PartOfStrip& part) const {
  const std::ptrdiff_t before = std::ptrdiff_t{part.row} * strips_;
  Strip& strip = turned.strips[static_cast<std::size_t>(before + part.first_column / FitSurvey::strip)];
  if (!strip.is_known) strip = bounds(turned, part.first_column, part.row);
  for (std::uint32_t left = strip.may_reach & part.blocks; left != 0; left &= left - 1) {
    const int column = part.first_column + std::countr_zero(left);
    if (reaches(turned, FitSurvey::top, column * FitSurvey::block, part.row * FitSurvey::block)) return true;
    strip.may_reach &= ~(1U << static_cast<unsigned>(column - part.first_column));
  }
  return false;
}

SurveyedScan::Strip SurveyedScan::bounds(const Turned& turned, int first_column, int row) const {
  constexpr std::size_t at_once = 65'535 / 255;  // beams whose fits a sum holds
  std::array<int, FitSurvey::strip> bounds{};
  const std::uint8_t* fits = survey_.top_fits_.data() + survey_.top_fits_.step(first_column, row);
  std::span<const std::ptrdiff_t> left = turned.of_tops;
  while (!left.empty()) {
    std::array<std::uint16_t, FitSurvey::strip> sums{};
    const std::size_t beams = std::min(left.size(), at_once);
    for (const std::ptrdiff_t beam : left.first(beams))
      for (std::size_t i = 0; i < sums.size(); ++i)
        sums[i] = static_cast<std::uint16_t>(sums[i] + fits[beam + static_cast<std::ptrdiff_t>(i)]);
    for (std::size_t i = 0; i < sums.size(); ++i) bounds[i] += sums[i];
    left = left.subspan(beams);
  }
  Strip strip{true, 0};
  for (std::size_t i = 0; i < bounds.size(); ++i)
    if (bounds[i] >= least_) strip.may_reach |= 1U << i;
  return strip;
}

bool SurveyedScan::reaches(const Turned& turned, int level, int x, int y) const {
  int score = 0;
  const std::uint8_t* fits = survey_.pyramid_.level(level) + survey_.pyramid_.step(x, y);
  for (const std::ptrdiff_t cell : turned.cells) score += fits[cell];
  if (score < least_) return false;
  if (level == 0) return true;
  const int half = 1 << (level - 1);
  return reaches(turned, level - 1, x, y) || reaches(turned, level - 1, x + half, y) ||
         reaches(turned, level - 1, x, y + half) || reaches(turned, level - 1, x + half, y + half);
}

}  // namespace isthmus
