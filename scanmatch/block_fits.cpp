#include "scanmatch/block_fits.hpp"

#include <iterator>
#include <span>

namespace isthmus {

BlockFits::BlockFits(const FitPyramid& pyramid, int level, int shifts)
    : block_(std::ptrdiff_t{1} << level),
      cells_(pyramid.step(0, 1)),
      width_((cells_ + block_ - 1) / block_ + shifts) {
  const std::span<const std::uint8_t> fits = pyramid.all(level);
  const std::ptrdiff_t rows = std::ssize(fits) / cells_;
  fits_.assign(static_cast<std::size_t>(rows * block_ * width_), 0);
  for (std::ptrdiff_t row = 0; row < rows; ++row) {
    const std::uint8_t* from = fits.data() + row * cells_;
    std::uint8_t* to = fits_.data() + row * block_ * width_;
    for (std::ptrdiff_t x = 0; x < cells_; ++x) to[x % block_ * width_ + x / block_] = from[x];
  }
}

std::ptrdiff_t BlockFits::index(std::ptrdiff_t cell) const {
  const std::ptrdiff_t row = cell / cells_;
  const std::ptrdiff_t x = cell % cells_;
  return (row * block_ + x % block_) * width_ + x / block_;
}

}  // namespace isthmus
