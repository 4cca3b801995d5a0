#pragma once

#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#include "server/engine/record/map_copy.hpp"
#include "server/wire/message/map_messages.hpp"
#include "server/wire/message/zone_messages.hpp"

namespace isthmus {

/// Sends a message; called from several threads, and must not throw.
using Publish = std::function<void(const std::string& channel, const std::vector<std::uint8_t>& bytes)>;

struct MapPublisherOptions {
  std::chrono::milliseconds whole_map_interval{60'000};  ///< and of the grids that go with it
  std::chrono::milliseconds grid_interval{5'000};        ///< at most one island's grid in this time
  std::size_t grid_pixels = 1'000'000;                   ///< larger islands are sent more coarsely
  std::chrono::milliseconds chunk_pause{2};  ///< so that a burst of chunks fits receivers' buffers
};

/// Publishes ISTHMUS_MAP, ISTHMUS_ZONES and ISTHMUS_GRID from copies of the map, in a thread of its own.
/// While it is busy only the latest copy waits. With each whole map the grids of all islands are sent, drawn
/// anew where they look otherwise now, unless drawing has taken its share of the time already: then as they
/// were drawn last. The grid of an island that is no more is withdrawn at once, by one of no cells.
class MapPublisher {
 public:
  MapPublisher(Publish publish, MapPublisherOptions options = {});
  ~MapPublisher();

  void offer(std::shared_ptr<const MapCopy> map, std::int64_t utime);
  /// The next copy is sent whole, and zones and grids with it.
  void request_whole();

 private:
  struct RenderedIsland {
    std::vector<Pose> poses;            ///< of its patches, when its grid was drawn
    std::vector<std::uint8_t> message;  ///< its grid
  };

  void loop(const std::stop_token& stop);
  void publish_map(const MapCopy& map, std::int64_t utime, bool whole, const std::stop_token& stop);
  void publish_zones(const MapCopy& map, std::int64_t utime, bool whole);
  void publish_all_grids(const MapCopy& map, std::int64_t utime, bool anew, const std::stop_token& stop);
  void withdraw_grids(const MapCopy& map, std::int64_t utime);
  void publish_one_grid(const MapCopy& map, std::int64_t utime);
  std::map<IslandId, std::vector<Pose>> changed_islands(const MapCopy& map) const;
  void render(const MapCopy& map, IslandId island, std::vector<Pose> poses, std::int64_t utime);

  Publish publish_;
  MapPublisherOptions options_;
  MapMessages messages_;
  ZoneMessages zones_;
  std::map<IslandId, RenderedIsland> rendered_;
  IslandId last_rendered_;

  std::mutex mutex_;
  std::condition_variable_any offered_;
  std::shared_ptr<const MapCopy> latest_;
  std::int64_t latest_utime_ = 0;
  bool whole_requested_ = true;
  std::jthread thread_;  ///< last: it uses all above
};

}  // namespace isthmus
