#pragma once

#include <map>
#include <string>

#include "patches/pose.hpp"

namespace isthmus {

/// A fixed tag on an island's plane.
struct PlacedTag {
  int island = 0;
  Eigen::Vector2d position = Eigen::Vector2d::Zero();
};

/// Reads an output's tags.csv, by barcode; tags that have no place are left out. Throws FileError naming file
/// and line.
std::map<std::int32_t, PlacedTag> read_placed_tags(const std::string& file);

/// Reads a truth's tags.csv, `barcode,x_m,y_m`. Throws FileError naming file and line.
std::map<std::int32_t, Eigen::Vector2d> read_true_tags(const std::string& file);

}  // namespace isthmus
