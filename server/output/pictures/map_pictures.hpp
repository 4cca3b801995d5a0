#pragma once

#include <deque>
#include <string>
#include <vector>

#include "server/output/pictures/island_content.hpp"
#include "server/output/pictures/marks.hpp"
#include "server/output/pictures/overview.hpp"

namespace isthmus {

/// Pictures of a map for people: island-K-trajectory.png of each island and overview.png of all of them, with
/// robots' ways, starts, ends and headings, patches, tags and closures. They are drawn some at a time, so
/// that memory does not grow with the number of islands nor with the length of ways. The map must outlive it.
class MapPictures {
 public:
  /// `max_waiting_pixels`: of sheets that wait for their ways; each time the whole trajectory is read.
  MapPictures(const MapCopy& map, const RankedIslands& islands, std::string directory,
              std::size_t max_waiting_pixels = 24'000'000);

  /// Islands in order of K, each with its grid. Throws std::runtime_error where a file cannot be written.
  void add(std::size_t island, const OccupancyGrid& grid);
  /// Draws and writes what is left, and the overview.
  void finish();

 private:
  struct Sheet {
    std::size_t island;
    MapSheet sheet;
  };
  /// A picture of an island: its sheet, or its part of the overview.
  struct Target {
    Canvas* canvas;
    MapWindow window;
    bool is_overview;
  };
  void draw_waiting();
  std::vector<Target> targets(int island);
  void draw_below_ways();
  void draw_ways();
  void draw_above_ways(const Target& target, std::size_t island);
  void draw_closures(const Target& target, std::size_t island, const ClosureStyle& style);
  void draw_ids(const Target& target, const IslandContent& content, Labels& labels);
  void draw_ends(const Target& target, std::size_t island, Labels& labels);
  void draw_tags(const Target& target, std::size_t island, Labels& labels);

  /// The first and last place of a session.
  struct Ends {
    int first_island = -1, last_island = -1;
    Pose first, last;
  };

  const MapCopy& map_;
  const RankedIslands& islands_;
  std::string directory_;
  std::vector<std::string> robots_;
  std::vector<IslandContent> contents_;
  std::vector<MapBox> held_;  ///< by K: of all that is drawn on its map
  OverviewSheet overview_;
  std::deque<Sheet> waiting_;
  std::size_t waiting_pixels_ = 0;
  std::size_t max_waiting_pixels_;
  std::map<std::int32_t, Ends> ends_;  ///< by session
};

}  // namespace isthmus
