#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cstdint>
#include <map>
#include <span>
#include <utility>
#include <vector>

#include "server/engine/record/map_copy.hpp"
#include "server/paths/ground/cell.hpp"

namespace isthmus {

/// A zone as it lies in the plane of its island, in metres. Where a fit has bent it so that it crosses
/// itself, all that it goes around is inside.
struct Zone {
  bool keep_out = true;
  double max_speed_m_s = 0;  ///< of a speed zone
  std::vector<Eigen::Vector2d> ring;
  Eigen::AlignedBox2d box;
};

/// Whether a disc of a radius that goes straight from one point to another comes into a zone.
bool comes_into(const Zone& zone, const Eigen::Vector2d& from, const Eigen::Vector2d& to, double radius_m);

/// The zones of a map, by islands. What projects alike is one to them: where a loop is not closed yet, both
/// stretches that lie there are in a zone.
class Zones {
 public:
  Zones() = default;
  /// Those that are lost are nowhere.
  explicit Zones(const MapCopy& map);

  std::span<const Zone> of(IslandId island) const;
  /// Takes an island's zones over from others.
  void keep(IslandId island, const Zones& others);
  bool any_keep_out(IslandId island) const;
  /// Whether a robot comes into a keep-out zone on its way.
  bool bars(IslandId island, const Eigen::Vector2d& from, const Eigen::Vector2d& to, double radius_m) const;
  /// Of the slowest speed zone that a robot comes into on its way, m/s; 0: it comes into none.
  double max_speed_m_s(IslandId island, const Eigen::Vector2d& from, const Eigen::Vector2d& to,
                       double radius_m) const;

 private:
  std::map<IslandId, std::vector<Zone>> zones_;
};

/// Whether two lists of zones are the same but for what a fit has moved by half a cell at most.
bool are_alike(std::span<const Zone> a, std::span<const Zone> b);

/// The cells whose centres lie in keep-out zones or nearer to one than a distance, row by row.
class KeptOutCells {
 public:
  KeptOutCells() = default;
  KeptOutCells(std::span<const Zone> zones, double within_m);

  bool contains(const Cell& cell) const;
  bool empty() const { return rows_.empty(); }

 private:
  using Spans = std::vector<std::pair<std::int32_t, std::int32_t>>;  ///< first and last column, in order

  void add(std::int32_t row, double low_m, double high_m);
  void add_inside(const Zone& zone);
  void add_around(const Eigen::Vector2d& a, const Eigen::Vector2d& b, double within_m);
  void join_spans();

  std::map<std::int32_t, Spans> rows_;
};

}  // namespace isthmus
