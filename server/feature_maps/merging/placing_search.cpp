#include "server/feature_maps/merging/placing_search.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <map>
#include <numbers>
#include <unordered_map>

#include "server/feature_maps/merging/placing_account.hpp"

namespace isthmus {
namespace {

/// How far a place on a wall's line lies beyond its ends.
double beyond_m(const MapWall& wall, const Eigen::Vector2d& place) {
  const double at = wall.along.dot(place - wall.a);
  return std::max({0.0, -at, at - wall.length_m});
}

double cross(const Eigen::Vector2d& a, const Eigen::Vector2d& b) { return a.x() * b.y() - a.y() * b.x(); }

/// Of where the middle of the second map lies, and how that is turned.
struct Bin {
  int votes = 0;
  Eigen::Vector2d sum = Eigen::Vector2d::Zero();
  double first_yaw = 0;
  double sum_yaw = 0;  ///< less the first
};

/// Votes in bins of place and heading; a heading's bins go round.
class Votes {
 public:
  explicit Votes(const MergingOptions& options)
      : bin_m_(options.bin_m),
        headings_(static_cast<std::int64_t>(std::round(2 * std::numbers::pi / options.bin_rad))) {}

  void add(const Eigen::Vector2d& place, double yaw) {
    Bin& bin = bins_[key(cell(place.x()), cell(place.y()), heading(yaw))];
    if (bin.votes++ == 0) bin.first_yaw = yaw;
    bin.sum += place;
    bin.sum_yaw += wrap_angle(yaw - bin.first_yaw);
  }

  struct Peak {
    int votes = 0;
    Eigen::Vector2d place;
    double yaw = 0;
  };
  /// Bins with what their neighbours have, most first.
  std::vector<Peak> peaks() const {
    std::vector<Peak> peaks;
    for (const auto& [where, bin] : bins_) {
      if (bin.votes < 2) continue;
      const double n = bin.votes;
      const Eigen::Vector2d place = bin.sum / n;
      Peak peak{0, place, wrap_angle(bin.first_yaw + bin.sum_yaw / n)};
      for (std::int64_t x = -1; x <= 1; ++x)
        for (std::int64_t y = -1; y <= 1; ++y)
          for (std::int64_t h = -1; h <= 1; ++h) {
            const auto found =
                bins_.find(key(cell(place.x()) + x, cell(place.y()) + y, heading(bin.first_yaw) + h));
            if (found != bins_.end()) peak.votes += found->second.votes;
          }
      peaks.push_back(peak);
    }
    std::sort(peaks.begin(), peaks.end(), [](const Peak& a, const Peak& b) {
      return std::tuple(-a.votes, a.place.x(), a.place.y(), a.yaw) <
             std::tuple(-b.votes, b.place.x(), b.place.y(), b.yaw);
    });
    return peaks;
  }

 private:
  std::int64_t cell(double at) const {
    constexpr double farthest_m = 1e6;
    return std::abs(at) < farthest_m ? static_cast<std::int64_t>(std::floor(at / bin_m_)) : 0;
  }
  std::int64_t heading(double yaw) const {
    const double turns = yaw / (2 * std::numbers::pi);
    return static_cast<std::int64_t>((turns - std::floor(turns)) * static_cast<double>(headings_));
  }
  std::uint64_t key(std::int64_t x, std::int64_t y, std::int64_t h) const {
    h = ((h % headings_) + headings_) % headings_;
    return (static_cast<std::uint64_t>(x) & 0xffffff) << 40 |
           (static_cast<std::uint64_t>(y) & 0xffffff) << 16 | static_cast<std::uint64_t>(h);
  }

  double bin_m_;
  std::int64_t headings_;
  std::unordered_map<std::uint64_t, Bin> bins_;
};

}  // namespace

std::vector<WallCorner> corners_of(const MapSketch& sketch, const MergingOptions& options) {
  std::vector<WallCorner> corners;
  for (std::size_t i = 0; i < sketch.walls.size(); ++i) {
    for (std::size_t k = 0; k < i; ++k) {  // the longest come first
      const MapWall *first = &sketch.walls[i], *second = &sketch.walls[k];
      if (cross(first->along, second->along) < 0) std::swap(first, second);
      const double sine = cross(first->along, second->along);
      if (sine < std::sin(options.min_corner_rad)) continue;
      const double at = cross(second->a - first->a, second->along) / sine;
      const Eigen::Vector2d place = first->a + at * first->along;
      if (beyond_m(*first, place) > options.corner_reach_m ||
          beyond_m(*second, place) > options.corner_reach_m)
        continue;
      corners.push_back({place, std::atan2(first->along.y(), first->along.x()),
                         std::atan2(sine, first->along.dot(second->along))});
      if (corners.size() >= options.max_corners) return corners;
    }
  }
  return corners;
}

std::vector<Pose> propose_placings(const MapSketch& one, const MapSketch& two,
                                   const MergingOptions& options) {
  const std::vector<WallCorner> corners_one = corners_of(one, options),
                                corners_two = corners_of(two, options);
  Votes votes(options);
  for (const WallCorner& b : corners_two) {
    for (const WallCorner& a : corners_one) {
      if (std::abs(a.turn_rad - b.turn_rad) > options.corner_tolerance_rad) continue;
      const double yaw = wrap_angle(a.heading_rad - b.heading_rad);
      votes.add(a.place + rotate(yaw, two.middle - b.place), yaw);
    }
  }
  struct Tried {
    std::size_t twins = 0;
    Pose pose;
  };
  std::vector<Tried> tried;
  for (const Votes::Peak& peak : votes.peaks()) {
    const Eigen::Vector2d offset = peak.place - rotate(peak.yaw, two.middle);
    const Pose pose{offset.x(), offset.y(), peak.yaw};
    const bool is_known = std::any_of(tried.begin(), tried.end(), [&](const Tried& other) {
      return (other.pose * two.middle - peak.place).norm() < options.bin_m &&
             std::abs(wrap_angle(other.pose.yaw - pose.yaw)) < options.bin_rad;
    });
    if (is_known) continue;
    tried.push_back({twins_at(one, two, pose, options.peak_m, options).size(), pose});
    if (tried.size() >= options.max_peaks) break;
  }
  std::stable_sort(tried.begin(), tried.end(),
                   [](const Tried& a, const Tried& b) { return a.twins > b.twins; });
  std::vector<Pose> placings;
  for (std::size_t i = 0; i < std::min(tried.size(), options.max_placings); ++i)
    placings.push_back(tried[i].pose);
  return placings;
}

}  // namespace isthmus
