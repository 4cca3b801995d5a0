#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace isthmus {

/// A PNG file in memory, rows from the top, one grey value a pixel. Throws std::runtime_error with libpng's
/// reason.
std::string grey_png(int width, int height, const std::vector<std::uint8_t>& pixels);

}  // namespace isthmus
