#pragma once

#include <string>

#include "server/engine/record/map_copy.hpp"
#include "server/output/tables/islands.hpp"

namespace isthmus {

/// The CSV files of tools/README.md. Islands are numbered by rank; -1 stands for "none". Poses are in the
/// island's frame, as are the patches' polygons.

/// `robot,island,from_s,to_s`: a row per robot and session, each robot's last one current.
void write_robots(const MapCopy& map, const RankedIslands& islands, const std::string& path);

/// A row per patch that is no fixed tag, with the exact covariance of (x, y, yaw) relative to the island's
/// first patch, in that patch's frame (nan where the relations leave it open), and the free space as WKT.
void write_patches(const MapCopy& map, const RankedIslands& islands, const std::string& path);

void write_relations(const MapCopy& map, const std::string& path);
void write_sightings(const MapCopy& map, const std::string& path);

/// A row per find of scans, as it was when it was made: the pose of the robot's patch (`query`) in that of
/// the place (`anchor`), and what speaks for it.
void write_finds(const MapCopy& map, const std::string& path);

/// Fixed tags, with the exact covariance of (x, y) relative to the island's first patch, in that patch's
/// frame, as patches have it; nan where a tag is not placed, or is on an island with no patch but tags.
void write_tags(const MapCopy& map, const RankedIslands& islands, const std::string& path);

}  // namespace isthmus
