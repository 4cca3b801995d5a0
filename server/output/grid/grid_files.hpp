#pragma once

#include <string>

#include "server/output/grid/grid.hpp"

namespace isthmus {

/// What map_server reads beside the picture of a grid, which is in a file of this name.
std::string grid_yaml(const OccupancyGrid& grid, const std::string& image);

/// Writes `stem`.pgm, .yaml and .png, the grid in map_server's convention (mode trinary).
void write_grid(const OccupancyGrid& grid, const std::string& stem);

/// Reads `stem`.pgm and .yaml as `write_grid` writes them. Throws std::runtime_error naming file and reason.
OccupancyGrid read_grid(const std::string& stem);

}  // namespace isthmus
