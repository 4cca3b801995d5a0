#pragma once

#include <Eigen/Core>
#include <map>
#include <utility>
#include <vector>

namespace isthmus {

/// Which lines pass a place: a grid of cells that know the lines near them. What stands in a cell is all
/// lines that pass within half a metre, and some that do not.
class LineGrid {
 public:
  /// A line may be put in again where it has grown.
  void insert(int line, const Eigen::Vector2d& from, const Eigen::Vector2d& to);

  /// The lines near a line: ascending, each once.
  std::vector<int> near(const Eigen::Vector2d& from, const Eigen::Vector2d& to) const;

 private:
  std::map<std::pair<int, int>, std::vector<int>> cells_;
};

}  // namespace isthmus
