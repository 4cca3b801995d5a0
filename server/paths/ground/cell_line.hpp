#pragma once

#include <algorithm>
#include <cstdint>
#include <cstdlib>
#include <utility>

#include "server/paths/ground/cell.hpp"

namespace isthmus {

/// The cells that a straight line from one cell's centre to another's comes through, in order (Amanatides and
/// Woo 1987). Through a corner it goes straight to the cell beyond.
class CellLine {
 public:
  CellLine(const Cell& from, const Cell& to)
      : at_(from), right_(to.x > from.x ? 1 : -1), up_(to.y > from.y ? 1 : -1) {
    const std::int64_t width = std::abs(to.x - from.x), height = std::abs(to.y - from.y);
    steep_ = height > width;
    length_ = std::max(width, height);
    rise_ = std::min(width, height);
  }

  bool done() const { return along_ == length_ && across_ == rise_; }
  const Cell& at() const { return at_; }

  /// To the next cell. Not when it is done.
  const Cell& step() {
    // Which side of the cells is crossed next, in halves of a cell.
    const std::int64_t next_along = (1 + 2 * along_) * rise_, next_across = (1 + 2 * across_) * length_;
    go_to(along_ + (next_along <= next_across), across_ + (next_across <= next_along));
    return at_;
  }

  /// To the last cell of the line that step() would come to after so many crossings along its longer side: no
  /// farther than that in rows and columns. cells > 0.
  const Cell& leap(std::int32_t cells) {
    const std::int64_t along = std::min(length_, along_ + cells);
    if (along == along_) return step();
    go_to(along, std::min(rise_, ((2 * along - 1) * rise_ + length_) / (2 * length_)));
    return at_;
  }

 private:
  void go_to(std::int64_t along, std::int64_t across) {
    auto by_x = static_cast<std::int32_t>(along - along_), by_y = static_cast<std::int32_t>(across - across_);
    if (steep_) std::swap(by_x, by_y);
    at_ = {at_.x + right_ * by_x, at_.y + up_ * by_y};
    along_ = along;
    across_ = across;
  }

  Cell at_;
  std::int32_t right_, up_;
  bool steep_ = false;
  std::int64_t length_ = 0, rise_ = 0;   // in cells, of the line
  std::int64_t along_ = 0, across_ = 0;  // sides that were crossed
};

}  // namespace isthmus
