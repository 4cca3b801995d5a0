#pragma once

#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <memory>
#include <mutex>
#include <optional>
#include <set>
#include <string>
#include <thread>
#include <vector>

#include "server/wire/goals/team_goals.hpp"
#include "server/wire/page/map/shown_map.hpp"
#include "server/wire/page/map/trails.hpp"
#include "server/wire/page/past_maps.hpp"
#include "server/wire/page/texts/asked.hpp"
#include "server/wire/page/texts/bulletin.hpp"
#include "server/wire/page/tiles/tile_store.hpp"

namespace isthmus {

/// What the page shows, made of what the live server gives it, in a thread of its own and of the lowest
/// priority: giving it something costs the live server a pointer or a copied pose, and never waits.
class PageModel {
 public:
  static constexpr std::chrono::milliseconds usual_interval{200};

  /// `journal_directory`: see PastMaps.
  explicit PageModel(std::chrono::milliseconds interval = usual_interval,
                     const std::string& journal_directory = "");
  ~PageModel();

  void show(RobotPose pose);  ///< any thread
  void show(LiveView view);   ///< any thread; only the newest counts
  void show(reply_t reply);   ///< any thread: what somebody has asked for
  void show(TeamGoals team);  ///< any thread: who explores what; only the newest counts

  /// Events of the topics robots (at most once an interval), trails, islands, tags, annotations, asked,
  /// exploration, closures, sightings, status, meeting and past.
  Bulletin& bulletin() { return bulletin_; }
  TileStore& tiles() { return tiles_; }
  PastMaps& past() { return past_; }
  /// See PastMaps::list; by the time of the newest map's first patch.
  std::string past_list();
  /// The newest map; none before the first.
  std::shared_ptr<const ShownMap> shown() const;
  /// Grows from one run to the next, and is no version of an earlier one.
  std::int64_t run() const { return run_; }

 private:
  void loop(const std::stop_token& stop);
  void take(LiveView view);
  void follow_drops(const ShownMap& map, bool is_first);
  void post(const ShownMap& map);

  std::chrono::milliseconds interval_;
  std::int64_t run_;
  Bulletin bulletin_;
  TileStore tiles_;
  PastMaps past_;
  Trails trails_;                  ///< of the thread
  std::set<std::string> dropped_;  ///< of the thread: robots
  Asked asked_;                    ///< of the thread
  std::int64_t version_;           ///< of the thread
  mutable std::mutex mutex_;
  std::condition_variable_any given_;
  std::vector<RobotPose> poses_;
  std::vector<reply_t> replies_;
  std::optional<LiveView> view_;
  std::optional<TeamGoals> team_;  ///< none: nobody has explored
  std::shared_ptr<const ShownMap> shown_;
  std::jthread thread_;  ///< last: it uses all above
};

}  // namespace isthmus
