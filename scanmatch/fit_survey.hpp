#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "scanmatch/block_fits.hpp"
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
  /// Shifts that are bounded together at first are a block of so many cells each way; and so many blocks,
  /// side by side, are looked at at once.
  static constexpr int top = 2;
  static constexpr int block = 1 << top;
  static constexpr int strip = 16;

  Eigen::Vector2d low_;
  Eigen::Vector2d high_;
  FitPyramid pyramid_;
  BlockFits top_fits_;
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
  /// Blocks side by side, from the lowest bit on: where some shift may have the score.
  struct Strip {
    bool is_known = false;
    std::uint32_t may_reach = 0;
  };
  /// Those of a strip that are in a window.
  struct PartOfStrip {
    int row = 0;
    int first_column = 0;  ///< of the strip
    std::uint32_t blocks = 0;
  };
  struct Turned {
    std::vector<std::ptrdiff_t> cells;    ///< in which beams end from the box's corner,
    std::vector<std::ptrdiff_t> of_tops;  ///< and in which blocks
    std::vector<Strip> strips;            ///< empty: this yaw was not asked for yet
  };

  std::vector<PartOfStrip> parts_of(const Pose& map_from_place, const SearchWindow& window) const;
  Turned& turned(int yaw_step);
  bool reaches(Turned& turned, const PartOfStrip& part) const;
  Strip bounds(const Turned& turned, int first_column, int row) const;
  bool reaches(const Turned& turned, int level, int x, int y) const;

  const FitSurvey& survey_;
  double block_m_;
  std::vector<Eigen::Vector2d> beams_;
  int least_;  ///< sum of fits over the beams
  double cell_m_;
  int columns_;
  int rows_;
  int strips_;                  ///< of a row
  std::vector<Turned> turned_;  ///< evenly all around
};

}  // namespace isthmus
