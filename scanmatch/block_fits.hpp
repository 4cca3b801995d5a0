#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "scanmatch/fit_pyramid.hpp"

namespace isthmus {

/// A level of a pyramid so laid out that, for one end of a beam, the bounds of its shifts by 0, 1, 2, ...
/// blocks to the right lie side by side: they are read at once.
class BlockFits {
 public:
  /// With room for so many shifts to the right of any cell.
  BlockFits(const FitPyramid& pyramid, int level, int shifts);

  /// Where the bound of a cell (FitPyramid::cell) is; it moves by `step` for a shift in blocks.
  std::ptrdiff_t index(std::ptrdiff_t cell) const;
  std::ptrdiff_t step(int columns, int rows) const { return rows * block_ * block_ * width_ + columns; }
  const std::uint8_t* data() const { return fits_.data(); }

 private:
  std::ptrdiff_t block_;
  std::ptrdiff_t cells_;  ///< of a row of the pyramid
  std::ptrdiff_t width_;
  std::vector<std::uint8_t> fits_;  ///< of each row cells 0, block, 2 block, ..., then 1, block + 1, ...
};

}  // namespace isthmus
