#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

namespace isthmus {

using Rgb = std::array<std::uint8_t, 3>;

/// PNG files in memory, rows from the top, one byte a pixel: a grey value, or a place in a palette of at most
/// 256 colours. Throw std::runtime_error with libpng's reason.
std::string grey_png(int width, int height, const std::vector<std::uint8_t>& pixels);
std::string palette_png(int width, int height, const std::vector<std::uint8_t>& pixels,
                        const std::vector<Rgb>& palette);

}  // namespace isthmus
