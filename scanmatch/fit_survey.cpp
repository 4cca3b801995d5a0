#include "scanmatch/fit_survey.hpp"

#include <algorithm>
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
      pyramid_(map, low + margin(-1, block, options), high + margin(1, block, options), options, top) {}

SurveyedScan::SurveyedScan(const FitSurvey& survey, std::span<const ScanPoint> points, double min_score,
                           const CorrelativeOptions& options)
    : survey_(survey),
      block_m_(FitSurvey::block * options.cell_m),
      beams_(searched_beams(points, options)),
      least_(static_cast<int>(min_score * 255.0 * static_cast<double>(beams_.size()))),
      columns_(static_cast<int>((survey.high_.x() - survey.low_.x()) / block_m_) + 1),
      rows_(static_cast<int>((survey.high_.y() - survey.low_.y()) / block_m_) + 1),
      turned_(static_cast<std::size_t>(std::ceil(2 * std::numbers::pi / options.yaw_step_rad))) {}

bool SurveyedScan::may_fit(const Pose& map_from_place, const SearchWindow& window) {
  const Pose centre = map_from_place * window.centre;
  const double c = std::abs(std::cos(map_from_place.yaw));
  const double s = std::abs(std::sin(map_from_place.yaw));
  const double half_x = c * window.half_x_m + s * window.half_y_m;
  const double half_y = s * window.half_x_m + c * window.half_y_m;
  const double radius = std::hypot(window.half_x_m, window.half_y_m);
  const auto number = [&](double at, int count) {
    return std::clamp(static_cast<int>(std::floor(at / block_m_)), 0, count - 1);
  };
  const double x = centre.x - survey_.low_.x();
  const double y = centre.y - survey_.low_.y();
  const double step_rad = 2 * std::numbers::pi / static_cast<double>(turned_.size());
  const int middle = static_cast<int>(std::lround(centre.yaw / step_rad));
  const int half_yaw =
      static_cast<int>(std::ceil(std::min(window.half_yaw_rad, std::numbers::pi) / step_rad));
  for (int k = middle - half_yaw; k <= middle + half_yaw; ++k) {
    Turned& at_yaw = turned(k);
    for (int row = number(y - half_y, rows_); row <= number(y + half_y, rows_); ++row) {
      const double off_y = beyond(y, row * block_m_, (row + 1) * block_m_);
      for (int column = number(x - half_x, columns_); column <= number(x + half_x, columns_); ++column) {
        const double off_x = beyond(x, column * block_m_, (column + 1) * block_m_);
        if (std::hypot(off_x, off_y) <= radius && says(at_yaw, column, row)) return true;
      }
    }
  }
  return false;
}

SurveyedScan::Turned& SurveyedScan::turned(int yaw_step) {
  const int count = static_cast<int>(turned_.size());
  Turned& turned = turned_[static_cast<std::size_t>((yaw_step % count + count) % count)];
  if (!turned.blocks.empty()) return turned;
  turned.blocks.assign(static_cast<std::size_t>(columns_) * static_cast<std::size_t>(rows_), Says::nothing);
  const double yaw = 2 * std::numbers::pi * yaw_step / count;
  const double c = std::cos(yaw);
  const double s = std::sin(yaw);
  turned.cells.reserve(beams_.size());
  for (const Eigen::Vector2d& beam : beams_)
    turned.cells.push_back(survey_.pyramid_.cell(
        survey_.low_ + Eigen::Vector2d(c * beam.x() - s * beam.y(), s * beam.x() + c * beam.y())));
  return turned;
}

bool SurveyedScan::says(Turned& turned, int column, int row) const {
  Says& says = turned.blocks[static_cast<std::size_t>(row) * static_cast<std::size_t>(columns_) +
                             static_cast<std::size_t>(column)];
  if (says == Says::nothing) {
    const bool fits = reaches(turned, FitSurvey::top, column * FitSurvey::block, row * FitSurvey::block);
    says = fits ? Says::yes : Says::no;
  }
  return says == Says::yes;
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
