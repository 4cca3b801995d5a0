#pragma once

#include <optional>
#include <string>
#include <vector>

#include "server/output/grid/grid.hpp"
#include "server/output/pictures/map_sheet.hpp"
#include "tools/evaluate/alignment.hpp"

namespace isthmus {

/// A wall of the truth's floor plan, in metres of the truth's frame.
struct TrueWall {
  Eigen::Vector2d a;
  Eigen::Vector2d b;
};

/// Reads floor_plan.csv, `ax_m,ay_m,bx_m,by_m`, as isthmus-simulate writes it. Throws FileError naming file
/// and line.
std::vector<TrueWall> read_floor_plan(const std::string& file);

/// How far the map is from the truth at one place of a robot's way.
struct ErrorAt {
  int island = 0;
  std::string robot;
  std::int64_t utime = 0;
  Eigen::Vector2d map_point = Eigen::Vector2d::Zero();
  double error_m = 0;
};

/// Of poses, after each island as a whole has been moved onto the truth.
std::vector<ErrorAt> errors_of_poses(const AbsoluteErrors& errors);
/// Of relations, where each begins.
std::vector<ErrorAt> errors_of_relations(const std::vector<TrueRelation>& relations,
                                         const TeamTrajectories& team);

/// What is drawn of one evaluation.
struct ErrorPictures {
  std::string
      output;        ///< what isthmus-replay or isthmus-server wrote: its grids are drawn where there are any
  std::string name;  ///< of the files: DIRECTORY/island-K-NAME.png
  std::string what;  ///< error of what, for title and axis
  bool joined = true;  ///< errors follow one another along a way; else each stands for itself
  std::vector<ErrorAt> errors;
  std::vector<std::string> robots;     ///< all that the map has, in the order of their colours
  std::vector<TrueWall> walls;         ///< none: the truth has no floor plan
  std::map<int, Pose> truth_from_map;  ///< by island; needed where there are walls
};

/// Island, what is off and by how much, and when. There must be errors.
SheetText error_sheet_text(const std::string& what, int island, const std::vector<ErrorAt>& errors);

/// Of each island that has errors one picture: the true walls over its grid, the errors along the robots'
/// ways by a scale of colours, and below them over time. Throws std::runtime_error naming file and reason.
void write_error_pictures(const ErrorPictures& pictures, const std::string& directory);

}  // namespace isthmus
