#include "server/output/grid/hits.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace isthmus {
namespace {

/// Neighbouring beams on one surface, at most so far apart, are joined into a wall.
constexpr double max_wall_gap_m = 0.3;
/// Where the line between them rises from either surface by no more than this,
constexpr double max_slope = 0.3;
/// and the cosine between the surfaces' normals is above this.
constexpr double min_alike = 0.9;

/// Whether the line between the hits of two neighbouring beams lies along the surface that both saw, and does
/// not lead from a near surface to a far one.
bool one_surface(const ScanPoint& a, const ScanPoint& b) {
  if (b.beam - a.beam != 1 || !a.has_normal() || !b.has_normal()) return false;
  const Eigen::Vector2d along = b.position - a.position;
  const double gap_m = along.norm();
  const double off_m = std::max(std::abs(a.normal.dot(along)), std::abs(b.normal.dot(along)));
  return gap_m <= max_wall_gap_m && off_m <= max_slope * gap_m && a.normal.dot(b.normal) > min_alike;
}

}  // namespace

bool within_free_space_range(const Patch& patch, const ScanPoint& point) {
  const Pose& laser = patch.laser.robot_from_laser;
  const double range_m = (point.position - position(laser)).norm();
  // Where beams were cut, the star reaches just as far; where none was, to the farthest hit.
  return range_m <= patch.star.reach_m() + 1e-3;
}

void Hits::add(const Patch& patch, const Pose& map_from_patch) {
  touched_.clear();
  const ScanPoint* previous = nullptr;
  for (const ScanPoint& point : patch.points) {
    if (!within_free_space_range(patch, point)) continue;
    const Eigen::Vector2d here = map_from_patch * point.position;
    touch(here);
    if (previous != nullptr && one_surface(*previous, point)) {
      touch_between(map_from_patch * previous->position, here);
    }
    previous = &point;
  }
  std::sort(touched_.begin(), touched_.end());
  const auto end = std::unique(touched_.begin(), touched_.end());
  for (auto cell = touched_.begin(); cell != end; ++cell) {
    if (counts_[*cell] < std::numeric_limits<std::uint16_t>::max()) ++counts_[*cell];
  }
}

void Hits::touch(const Eigen::Vector2d& map_point) {
  const Eigen::Vector2d cell = lattice_.cells(map_point);
  if (!(cell.x() >= 0 && cell.x() < lattice_.width && cell.y() >= 0 && cell.y() < lattice_.height)) return;
  touched_.push_back(lattice_.index(static_cast<int>(cell.x()), static_cast<int>(cell.y())));
}

void Hits::touch_between(const Eigen::Vector2d& map_from, const Eigen::Vector2d& map_to) {
  const int parts = static_cast<int>(std::ceil(2 * (map_to - map_from).norm() / lattice_.resolution_m));
  for (int i = 1; i < parts; ++i) touch(map_from + (map_to - map_from) * (static_cast<double>(i) / parts));
}

}  // namespace isthmus
