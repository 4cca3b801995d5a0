#include "server/output/grid/grid_files.hpp"

#include <cmath>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <stdexcept>

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

}  // namespace

std::string grid_yaml(const OccupancyGrid& grid, const std::string& image) {
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

namespace {

std::string read_file(const std::string& path) {
  std::ifstream stream(path, std::ios::binary);
  std::ostringstream bytes;
  bytes << stream.rdbuf();
  if (!stream) throw std::runtime_error(path + ": cannot be read");
  return bytes.str();
}

/// The text after `key` at the beginning of a line.
std::istringstream after_key(const std::string& text, const std::string& key, const std::string& path) {
  const std::size_t at = ("\n" + text).find("\n" + key);
  if (at == std::string::npos) throw std::runtime_error(path + ": has no " + key);
  return std::istringstream(text.substr(at + key.size()));
}

void read_pgm(const std::string& path, OccupancyGrid& grid) {
  const std::string bytes = read_file(path);
  std::istringstream header(bytes);
  std::string magic;
  int most = 0;
  header >> magic >> grid.width >> grid.height >> most;
  constexpr int max_side = 100'000;
  const bool good = header && magic == "P5" && most == 255 && grid.width > 0 && grid.height > 0 &&
                    grid.width <= max_side && grid.height <= max_side;
  const std::size_t size =
      good ? static_cast<std::size_t>(grid.width) * static_cast<std::size_t>(grid.height) : 0;
  if (!good || bytes.size() < size + 1 || static_cast<std::size_t>(header.tellg()) + 1 + size != bytes.size())
    throw std::runtime_error(path + ": is no grid of isthmus");
  const auto* first = reinterpret_cast<const std::uint8_t*>(bytes.data()) + (bytes.size() - size);
  grid.pixels.assign(first, first + size);
}

}  // namespace

OccupancyGrid read_grid(const std::string& stem) {
  const std::string path = stem + ".yaml", text = read_file(path);
  OccupancyGrid grid;
  char bracket = 0, comma = 0;
  auto resolution = after_key(text, "resolution:", path), origin = after_key(text, "origin:", path);
  resolution >> grid.resolution_m;
  origin >> bracket >> grid.origin_x_m >> comma >> grid.origin_y_m;
  if (!resolution || !origin || bracket != '[' || comma != ',' || !(grid.resolution_m > 0) ||
      !std::isfinite(grid.origin_x_m) || !std::isfinite(grid.origin_y_m))
    throw std::runtime_error(path + ": resolution or origin cannot be read");
  read_pgm(stem + ".pgm", grid);
  return grid;
}

void write_grid(const OccupancyGrid& grid, const std::string& stem) {
  write_file(stem + ".pgm", pgm(grid));
  write_file(stem + ".png", grey_png(grid.width, grid.height, grid.pixels));
  write_file(stem + ".yaml", grid_yaml(grid, std::filesystem::path(stem).filename().string() + ".pgm"));
}

}  // namespace isthmus
