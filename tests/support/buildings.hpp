#pragma once

#include <initializer_list>

#include "tests/support/walls.hpp"

namespace isthmus::testing {

/// A hall of 48 m by 12 m with crates, no two of which are of one size; a robot drives along y = 6.
inline Walls store_of_crates() {
  Walls walls;
  add_box(walls, 0, 0, 48, 12);
  double x = 2, size = 1.1;
  for (const double y : {1.2, 8.6, 2.3, 7.9, 0.8, 9.3, 2.9, 8.2, 1.7, 7.7, 1.1, 8.9}) {
    add_box(walls, x, y, x + 1.2 + 0.4 * size, y + 1.1 + 0.3 * size);
    size = size > 1.9 ? 0.3 * size : size + 0.43;
    x += 2.6 + 0.7 * size;
  }
  return walls;
}

/// A corridor without ends between rooms of 4 m, all alike.
inline Walls alike_rooms() {
  Walls walls;
  for (int room = -6; room < 18; ++room) {
    const double x = 4.0 * room;
    walls.push_back({{x, 5}, {x + 2.6, 5}});  // a door of 1.4 m
    walls.push_back({{x, 5}, {x, 10}});
    walls.push_back({{x, 3}, {x + 1.5, 3}});
    walls.push_back({{x + 2.7, 3}, {x + 4, 3}});
    add_box(walls, x + 1.2, 8, x + 2.6, 9.2);
  }
  walls.push_back({{-24, 10}, {72, 10}});
  return walls;
}

}  // namespace isthmus::testing
