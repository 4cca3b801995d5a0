#pragma once

#include "server/output/grid/grid.hpp"
#include "server/output/pictures/canvas.hpp"

namespace isthmus {

/// A grid in the light colours of pictures, each pixel of `cells_per_pixel`² cells from its top left on. A
/// wall that is one cell thick stays as dark as a thick one, however many cells there are to a pixel.
Image shade(const OccupancyGrid& grid, int cells_per_pixel);

}  // namespace isthmus
