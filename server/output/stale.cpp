#include "server/output/stale.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <filesystem>
#include <set>
#include <string_view>

#include "server/output/tables/trajectories.hpp"

namespace isthmus {
namespace {

namespace fs = std::filesystem;

/// K of a file that this program names island-K.pgm and so on.
bool island_of(std::string_view name, std::size_t& island) {
  constexpr std::string_view prefix = "island-";
  if (!name.starts_with(prefix)) return false;
  name.remove_prefix(prefix.size());
  const auto [end, error] = std::from_chars(name.data(), name.data() + name.size(), island);
  if (error != std::errc{}) return false;
  name.remove_prefix(static_cast<std::size_t>(end - name.data()));
  constexpr std::array<std::string_view, 7> written = {
      ".pgm", ".yaml", ".png", "-trajectory.png", "-plan.svg", "-plan.dxf", "-plan.geojson"};
  return std::find(written.begin(), written.end(), name) != written.end();
}

std::vector<fs::path> files_in(const fs::path& directory) {
  std::vector<fs::path> files;
  std::error_code error;
  for (fs::directory_iterator entry(directory, error), end; !error && entry != end; entry.increment(error)) {
    if (entry->is_regular_file(error)) files.push_back(entry->path());
  }
  return files;
}

}  // namespace

void remove_stale(const std::string& directory, std::size_t islands, const std::vector<std::string>& robots) {
  std::error_code ignored;  // a file that cannot be removed is no reason to fail an export
  for (const fs::path& file : files_in(directory)) {
    std::size_t island = 0;
    if (island_of(file.filename().string(), island) && island >= islands) fs::remove(file, ignored);
  }
  std::set<std::string> current;
  for (const std::string& robot : robots) current.insert(file_name_of(robot) + ".tum");
  for (const fs::path& file : files_in(fs::path(directory) / "trajectories")) {
    if (file.extension() == ".tum" && !current.contains(file.filename().string())) fs::remove(file, ignored);
  }
}

}  // namespace isthmus
