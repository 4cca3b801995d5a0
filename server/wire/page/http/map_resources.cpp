#include "server/wire/page/http/map_resources.hpp"

#include <httplib.h>

#include <memory>
#include <string>
#include <vector>

namespace isthmus {
namespace {

using httplib::Request;
using httplib::Response;
using Numbers = std::vector<std::int32_t>;

/// Of what there is not, or not any more: islands merge between a viewer's list of them and its question,
/// which is no error.
void tell_gone(Response& response) {
  response.status = 204;
  response.set_header("Cache-Control", "no-store");
}

void tiles(TileStore& tiles, const Request& request, const Numbers& numbers, Response& response) {
  if (numbers.size() != 1) return refuse(response, 404, "/tiles/ISLAND?since=VERSION");
  nlohmann::json list = nlohmann::json::array();
  for (const auto& [key, version] : tiles.changed_since(IslandId{numbers[0]}, version_of(request, "since")))
    list.push_back(nlohmann::json::array({key.zoom, key.x, key.y, version}));
  answer(response, 200, list);
}

void tile(TileStore& tiles, const Request& request, const Numbers& numbers, Response& response) {
  if (numbers.size() != 4) return refuse(response, 404, "/tile/ISLAND/ZOOM/X/Y?v=VERSION");
  const auto image = tiles.image(IslandId{numbers[0]}, {numbers[1], numbers[2], numbers[3]});
  if (!image) return tell_gone(response);
  answer(response, image->png, "image/png");
  if (image->version == version_of(request, "v")) keep_forever(response);
}

void patches(const MapOnPage& map, const Request& request, const Numbers& numbers, Response& response) {
  if (numbers.size() != 1) return refuse(response, 404, "/patches/ISLAND?v=VERSION");
  if (!map.shown || !map.shown->version.contains(IslandId{numbers[0]})) return tell_gone(response);
  const IslandId island{numbers[0]};
  if (request.get_header_value("Accept-Encoding").find("deflate") == std::string::npos) {
    answer(response, std::make_shared<const std::string>(patch_arrays(*map.shown, island)),
           "application/octet-stream");
  } else {
    answer(response, map.packed.packed(*map.shown, island), "application/octet-stream");
    response.set_header("Content-Encoding", "deflate");
  }
  if (map.shown->version.at(island) == version_of(request, "v")) keep_forever(response);
}

}  // namespace

bool get_of_map(const MapOnPage& map, std::string_view path, const Request& request, Response& response) {
  if (path.starts_with("/tiles/")) {
    tiles(map.tiles, request, numbers_behind(path, "/tiles"), response);
  } else if (path.starts_with("/tile/")) {
    tile(map.tiles, request, numbers_behind(path, "/tile"), response);
  } else if (path.starts_with("/patches/")) {
    patches(map, request, numbers_behind(path, "/patches"), response);
  } else {
    return false;
  }
  return true;
}

}  // namespace isthmus
