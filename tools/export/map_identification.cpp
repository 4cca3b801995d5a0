#include "tools/export/map_identification.hpp"

#include <nlohmann/json.hpp>
#include <span>

#include "server/output/format/atomic_file.hpp"
#include "server/output/tables/islands.hpp"
#include "server/wire/file/digest.hpp"
#include "server/wire/file/text_file.hpp"

namespace isthmus {
namespace {

constexpr std::size_t version_digits = 16;

std::string hex(const Digest& digest) {
  std::string digits;
  for (const std::uint8_t byte : digest) {
    digits += "0123456789abcdef"[byte >> 4];
    digits += "0123456789abcdef"[byte & 15];
  }
  return digits;
}

std::string hash_of_file(const std::string& file) {
  const std::string bytes = read_text_file(file);
  return hex(sha256({reinterpret_cast<const std::uint8_t*>(bytes.data()), bytes.size()}));
}

}  // namespace

void write_map_identification(const MapCopy& map, const std::string& name, const std::string& link,
                              const std::string& directory) {
  const std::string base = link.ends_with("/") ? link : link + "/";
  const std::string version = map_sha256(map).substr(0, version_digits);
  nlohmann::ordered_json maps = nlohmann::ordered_json::array();
  const RankedIslands islands = rank_islands(map);
  const std::string name_of_islands = name + "-", grids = directory + "/";
  for (std::size_t k = 0; k < islands.patches.size(); ++k) {
    const std::string grid = "island-" + std::to_string(k) + ".pgm";
    const std::string first_patch = std::to_string(islands.patches[k].front().value);
    maps.push_back({{"mapId", name_of_islands + first_patch},
                    {"mapVersion", version},
                    {"mapDownloadLink", base + grid},
                    {"mapHash", hash_of_file(grids + grid)}});
  }
  AtomicFile file(directory + "/vda5050-maps.json");
  file.write(maps.dump(2) + "\n");
  file.commit();
}

}  // namespace isthmus
