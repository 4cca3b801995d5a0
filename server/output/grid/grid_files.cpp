#include "server/output/grid/grid_files.hpp"

#include <filesystem>

#include "server/output/format/atomic_file.hpp"
#include "server/output/format/number.hpp"
#include "server/output/format/png.hpp"

namespace isthmus {
namespace {

void write_file(const std::string& path, std::string_view bytes) {
  AtomicFile file(path);
  file.write(bytes);
  file.commit();
}

std::string pgm(const OccupancyGrid& grid) {
  std::string bytes = "P5\n" + std::to_string(grid.width) + " " + std::to_string(grid.height) + "\n255\n";
  bytes.append(reinterpret_cast<const char*>(grid.pixels.data()), grid.pixels.size());
  return bytes;
}

std::string yaml(const OccupancyGrid& grid, const std::string& image) {
  // Unknown is 205 and reads back as an occupancy of 0.19608: a larger free_thresh would turn it into free.
  return "image: " + image +
         "\n"
         "mode: trinary\n"
         "resolution: " +
         number(grid.resolution_m) +
         "\n"
         "origin: [" +
         fixed(grid.origin_x_m, 6) + ", " + fixed(grid.origin_y_m, 6) +
         ", 0.0]\n"
         "negate: 0\n"
         "occupied_thresh: 0.65\n"
         "free_thresh: 0.196\n";
}

}  // namespace

void write_grid(const OccupancyGrid& grid, const std::string& stem) {
  write_file(stem + ".pgm", pgm(grid));
  write_file(stem + ".png", grey_png(grid.width, grid.height, grid.pixels));
  write_file(stem + ".yaml", yaml(grid, std::filesystem::path(stem).filename().string() + ".pgm"));
}

}  // namespace isthmus
