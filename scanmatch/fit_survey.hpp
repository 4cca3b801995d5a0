#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "scanmatch/correlative.hpp"
#include "scanmatch/fit_pyramid.hpp"

namespace isthmus {

/// A whole map as one grid, by which is told where a scan cannot lie: at a small part of what a search there
/// costs (search_window), and at once for all places, however many windows they are in.
class FitSurvey {
 public:
  /// Of the poses whose position is in the box from `low` to `high`, in the map's frame.
  FitSurvey(std::span<const Eigen::Vector2d> map, const Eigen::Vector2d& low, const Eigen::Vector2d& high,
            const CorrelativeOptions& options);

 private:
  friend class SurveyedScan;
  /// Shifts that are bounded together at first are a block of so many cells each way.
  static constexpr int top = 4;
  static constexpr int block = 1 << top;

  Eigen::Vector2d low_;
  Eigen::Vector2d high_;
  FitPyramid pyramid_;
};

/// A scan on a surveyed map.
class SurveyedScan {
 public:
  /// The survey must live on.
  SurveyedScan(const FitSurvey& survey, std::span<const ScanPoint> points, double min_score,
               const CorrelativeOptions& options);

  /// False: nowhere in the window, in the frame of a place that lies so in the map, does it fit with that
  /// score: neither would a search of any part of the map there find it, but for what is lost between the
  /// steps of either (of 330 answers of recorded teams and a simulated one, among 48,000 windows, none was).
  bool may_fit(const Pose& map_from_place, const SearchWindow& window);

 private:
  enum class Says : std::uint8_t { nothing, no, yes };
  struct Turned {
    std::vector<std::ptrdiff_t> cells;  ///< in which beams end from the box's corner
    std::vector<Says> blocks;           ///< empty: this yaw was not asked for yet
  };

  Turned& turned(int yaw_step);
  bool says(Turned& turned, int column, int row) const;
  bool reaches(const Turned& turned, int level, int x, int y) const;

  const FitSurvey& survey_;
  double block_m_;
  std::vector<Eigen::Vector2d> beams_;
  int least_;  ///< sum of fits over the beams
  int columns_;
  int rows_;
  std::vector<Turned> turned_;  ///< evenly all around
};

}  // namespace isthmus
