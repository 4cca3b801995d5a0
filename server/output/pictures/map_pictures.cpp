#include "server/output/pictures/map_pictures.hpp"

#include <algorithm>
#include <optional>
#include <utility>

#include "server/output/pictures/marks.hpp"
#include "server/output/pictures/way_pen.hpp"
#include "server/output/tables/trajectories.hpp"

namespace isthmus {
namespace {

/// Around islands on the overview.
constexpr double overview_margin_m = 0.25;
constexpr double small_label = 0.85;  ///< of the height of a line of text

std::vector<MapBox> boxes_of(const MapCopy& map, const RankedIslands& islands) {
  std::vector<MapBox> boxes;
  for (const std::vector<PatchId>& patches : islands.patches) {
    MapBox box = island_box(map, patches);
    box.low.array() -= overview_margin_m;
    box.high.array() += overview_margin_m;
    boxes.push_back(box);
  }
  return boxes;
}

Eigen::Vector2d place_of(const MapCopy& map, PatchId patch) {
  return position(map.poses.at(static_cast<std::size_t>(patch.value)));
}

/// Of all that is drawn on islands' maps, by K.
std::vector<MapBox> held_boxes(const MapCopy& map, const RankedIslands& islands,
                               const std::vector<IslandContent>& contents) {
  std::vector<MapBox> boxes(contents.size());
  for (const IslandContent& content : contents) {
    MapBox& box = boxes[content.island];
    for (const TagRecord* tag : content.tags) box.include(tag->position);
    for (const ShownClosure& closure : content.closures)
      for (const PatchId end : {closure.a, closure.b})
        if (const Eigen::Vector2d place = place_of(map, end); place.allFinite()) box.include(place);
  }
  for_each_row(map, [&](const ProjectedRow& row) {
    const int island = islands.rank(row.patch);
    if (island >= 0 && is_finite(row.map_from_robot))
      boxes[static_cast<std::size_t>(island)].include(position(row.map_from_robot));
  });
  return boxes;
}

}  // namespace

MapPictures::MapPictures(const MapCopy& map, const RankedIslands& islands, std::string directory,
                         std::size_t max_waiting_pixels)
    : map_(map),
      islands_(islands),
      directory_(std::move(directory)),
      robots_(robots_as_they_came(map)),
      contents_(island_contents(map, islands)),
      held_(held_boxes(map, islands, contents_)),
      overview_(contents_, boxes_of(map, islands), robots_),
      max_waiting_pixels_(max_waiting_pixels) {}

void MapPictures::add(std::size_t island, const OccupancyGrid& grid) {
  const IslandContent& content = contents_.at(island);
  waiting_.push_back(
      {island, MapSheet(grid, sheet_text(content), island_legend(content, robots_), 0, held_.at(island))});
  if (overview_.shows(island)) overview_.draw(island, grid);
  const SheetLayout& layout = waiting_.back().sheet.layout();
  waiting_pixels_ += static_cast<std::size_t>(layout.width) * static_cast<std::size_t>(layout.height);
  if (waiting_pixels_ > max_waiting_pixels_) draw_waiting();
}

void MapPictures::finish() {
  draw_waiting();
  overview_.canvas().write(directory_ + "/overview.png");
}

std::vector<MapPictures::Target> MapPictures::targets(int island) {
  std::vector<Target> found;
  if (waiting_.empty() || island < static_cast<int>(waiting_.front().island)) return found;
  const std::size_t k = static_cast<std::size_t>(island), at = k - waiting_.front().island;
  if (at >= waiting_.size()) return found;
  found.push_back({&waiting_[at].sheet.canvas(), waiting_[at].sheet.window(), false});
  if (overview_.shows(k)) found.push_back({&overview_.canvas(), overview_.window(k), true});
  return found;
}

void MapPictures::draw_waiting() {
  draw_below_ways();
  draw_ways();
  for (const Sheet& sheet : waiting_)
    for (const Target& target : targets(static_cast<int>(sheet.island)))
      draw_above_ways(target, sheet.island);
  for (const Sheet& sheet : waiting_)
    sheet.sheet.write(directory_ + "/island-" + std::to_string(sheet.island) + "-trajectory.png");
  waiting_.clear();
  waiting_pixels_ = 0;
}

void MapPictures::draw_below_ways() {
  std::map<std::string, Rgb> colours;
  for (std::size_t i = 0; i < robots_.size(); ++i) colours[robots_[i]] = way_style(i).colour;
  for (Sheet& waiting : waiting_) {
    MapSheet& sheet = waiting.sheet;
    sheet.canvas().clip(sheet.window().box);
    const ClosureStyle loops = loop_style(contents_[waiting.island].loops());
    if (loops.opacity < 1) draw_closures({&sheet.canvas(), sheet.window(), false}, waiting.island, loops);
    for (const PatchId id : islands_.patches[waiting.island]) {
      const auto colour = colours.find(map_.patches[static_cast<std::size_t>(id.value)]->robot);
      if (colour != colours.end())
        draw_patch(sheet.canvas(), sheet.window(), place_of(map_, id), colour->second);
    }
    sheet.canvas().unclip();
  }
}

/// The loops of an island, or its merges.
void MapPictures::draw_closures(const Target& target, std::size_t island, const ClosureStyle& style) {
  for (const ShownClosure& closure : contents_[island].closures)
    if (closure.is_merge == style.is_merge)
      draw_closure(*target.canvas, target.window, place_of(map_, closure.a), place_of(map_, closure.b),
                   style);
}

void MapPictures::draw_ways() {
  std::map<std::string, std::size_t> index;
  for (const std::string& robot : robots_) index.emplace(robot, index.size());
  /// Of one session, on the island where it was last.
  struct Pens {
    int island = -1;
    std::deque<WayPen> pens;
  };
  std::map<std::int32_t, Pens> pens;
  ends_.clear();
  for_each_row(map_, [&](const ProjectedRow& row) {
    const int island = islands_.rank(row.patch);
    if (!is_finite(row.map_from_robot)) return;
    Ends& ends = ends_[row.session.number];
    if (ends.first_island < 0)
      std::tie(ends.first_island, ends.first) = std::pair(island, row.map_from_robot);
    std::tie(ends.last_island, ends.last) = std::pair(island, row.map_from_robot);
    Pens& own = pens[row.session.number];
    if (own.island != island) {
      own.pens.clear();
      own.island = island;
      for (const Target& target : targets(island))
        own.pens.emplace_back(*target.canvas, target.window, way_style(index.at(row.session.robot)));
    }
    for (WayPen& pen : own.pens) pen.to(position(row.map_from_robot));
  });
}

void MapPictures::draw_above_ways(const Target& target, std::size_t island) {
  Canvas& canvas = *target.canvas;
  const IslandContent& content = contents_[island];
  Labels labels(target.window);
  canvas.clip(target.window.box);
  if (!target.is_overview) {
    const ClosureStyle loops = loop_style(content.loops());
    if (loops.opacity >= 1) draw_closures(target, island, loops);
    draw_closures(target, island, {.is_merge = true});
  }
  draw_ends(target, island, labels);
  if (!target.is_overview) {
    draw_tags(target, island, labels);
    draw_ids(target, content, labels);
  }
  canvas.unclip();
}

void MapPictures::draw_ids(const Target& target, const IslandContent& content, Labels& labels) {
  for (const ShownClosure& closure : content.closures)
    if (content.are_named(closure.is_merge))
      labels.draw(*target.canvas, std::to_string(closure.id.value),
                  closure_middle(place_of(map_, closure.a), place_of(map_, closure.b)),
                  {.size_px = small_label * target.window.em, .colour = ink::closure});
}

void MapPictures::draw_ends(const Target& target, std::size_t island, Labels& labels) {
  std::map<std::string, std::size_t> index;
  for (const std::string& robot : robots_) index.emplace(robot, index.size());
  std::map<std::size_t, Eigen::Vector2d> last;  // by robot, of its last session here
  const auto robot_of = [&](std::int32_t session) {
    return index.at(map_.sessions[static_cast<std::size_t>(session)].robot);
  };
  for (const auto& [session, ends] : ends_) {
    if (ends.first_island != static_cast<int>(island)) continue;
    draw_start(*target.canvas, target.window, ends.first, way_style(robot_of(session)));
    labels.keep_free(position(ends.first));
  }
  // Above all starts: one robot may have begun where another ended, and an arrow leaves a circle to be seen.
  for (const auto& [session, ends] : ends_) {
    if (ends.last_island != static_cast<int>(island)) continue;
    draw_end(*target.canvas, target.window, ends.last, way_style(robot_of(session)));
    labels.keep_free(position(ends.last));
    last[robot_of(session)] = position(ends.last);
  }
  for (const auto& [robot, place] : last)
    labels.draw(*target.canvas, robots_[robot], place,
                {.size_px = target.window.em, .colour = way_style(robot).colour, .bold = true});
}

void MapPictures::draw_tags(const Target& target, std::size_t island, Labels& labels) {
  for (const TagRecord* tag : contents_[island].tags) {
    draw_tag(*target.canvas, target.window, tag->position);
    labels.draw(*target.canvas, std::to_string(tag->barcode), tag->position,
                {.size_px = small_label * target.window.em, .bold = true});
  }
}

}  // namespace isthmus
