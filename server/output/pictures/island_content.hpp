#pragma once

#include <map>
#include <string>
#include <vector>

#include "server/engine/record/map_copy.hpp"
#include "server/output/pictures/legend.hpp"
#include "server/output/pictures/map_sheet.hpp"
#include "server/output/tables/islands.hpp"

namespace isthmus {

/// A closure that holds on an island, and two patches of those that it relates.
struct ShownClosure {
  ClosureId id;
  bool is_merge = false;
  PatchId a;
  PatchId b;
};

/// What pictures of an island show beside its grid and its robots' ways.
struct IslandContent {
  std::size_t island = 0;   ///< K
  std::size_t islands = 0;  ///< how many there are
  std::vector<std::size_t>
      robots;  ///< indices among all robots as they came, whose patches or sessions are here
  std::size_t patches = 0;
  std::vector<const TagRecord*> tags;  ///< placed ones
  std::vector<ShownClosure> closures;  ///< by id
  std::int64_t from_utime = 0;         ///< of its sessions, by the robots' stamps
  std::int64_t to_utime = 0;

  std::size_t loops() const;  ///< closures that are no merges
  /// Of many loops none has its id on the map, which they would cover.
  bool are_named(bool merges) const;
};

/// By K. The map must outlive them.
std::vector<IslandContent> island_contents(const MapCopy& map, const RankedIslands& islands);

/// Island, counts and time.
SheetText sheet_text(const IslandContent& content);
/// Robots by `names` with their styles, and the marks that are on the picture.
Legend island_legend(const IslandContent& content, const std::vector<std::string>& names);
/// Of so many robots the first few, and how many more there are.
void add_robots(Legend& legend, const std::vector<std::size_t>& robots,
                const std::vector<std::string>& names);

/// "3 patches", "1 patch".
std::string counted(std::size_t count, const std::string& one, const std::string& many);
/// From one stamp to another, as date and time of UTC, or in seconds where stamps count from something else
/// than 1970.
std::string time_text(std::int64_t from_utime, std::int64_t to_utime);

}  // namespace isthmus
