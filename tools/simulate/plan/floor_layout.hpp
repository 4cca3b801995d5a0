#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "server/engine/input/words.hpp"
#include "tools/simulate/plan/floor_plan.hpp"

namespace isthmus {

/// How corridors divide a floor.
enum class Corridors : std::uint8_t {
  any,    ///< one of these, as drawn from the seed
  ring,   ///< round the floor and through it
  spine,  ///< one, and its branches
};

template <>
inline constexpr auto words_of<Corridors> = std::to_array<std::string_view>({"any", "ring", "spine"});

/// What a generated floor should be like; a length of 0 is drawn from the seed.
struct FloorStyle {
  double area_m2 = 600;
  std::uint64_t seed = 1;  ///< another seed, another building
  Corridors corridors = Corridors::any;
  double corridor_m = 0;    ///< width
  double room_m = 0;        ///< rooms are at most this long, but for halls
  double hall_share = 0.1;  ///< of the rooms that could be large
  double furniture = 1;     ///< times the usual number of pieces
};

/// A rectangle of floor: a room, or a piece of corridor. Cells tile the floor.
struct FloorCell {
  Eigen::Vector2d low;
  Eigen::Vector2d high;
  bool corridor = false;
  bool along_x = false;  ///< of a corridor: which way it runs

  Eigen::Vector2d size() const { return high - low; }
  Eigen::Vector2d middle() const { return 0.5 * (low + high); }
};

/// What two cells share: the piece of the line x = at (upright) or y = at between `from` and `to`.
struct FloorBorder {
  std::size_t a = 0;
  std::size_t b = 0;
  bool upright = false;
  double at = 0;
  double from = 0;
  double to = 0;

  double length() const { return to - from; }
  Eigen::Vector2d point(double along) const {
    return upright ? Eigen::Vector2d(at, along) : Eigen::Vector2d(along, at);
  }
};

struct FloorDoor {
  std::size_t border = 0;
  double along = 0;  ///< its middle: y in an upright border, else x
  double width_m = 1;
};

struct FloorLayout {
  Eigen::Vector2d size = Eigen::Vector2d::Zero();  ///< from the origin
  std::vector<FloorCell> cells;
  std::vector<FloorBorder> borders;
  std::vector<FloorDoor> doors;
};

/// Corridors that hang together, rooms between them, and a door to every room that a door can reach.
FloorLayout lay_out_floor(const FloorStyle& style);

/// Adds the borders of all its cells, between each two that touch.
void find_borders(FloorLayout& layout);

std::vector<Wall> walls_of(const FloorLayout& layout);

}  // namespace isthmus
