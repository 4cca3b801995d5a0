#pragma once

#include <Eigen/Core>
#include <vector>

#include "tools/simulate/plan/floor_layout.hpp"

namespace isthmus {

/// A room with a door to a corridor.
struct FloorStop {
  std::size_t room = 0;  ///< cell
  std::size_t node = 0;  ///< in the corridor, before the door
  Eigen::Vector2d door;
  Eigen::Vector2d inward;  ///< unit, through the door
};

/// The corridors as a graph: nodes on their middle lines, where they cross and before doors.
class FloorRoutes {
 public:
  explicit FloorRoutes(const FloorLayout& layout);

  const std::vector<FloorStop>& stops() const { return stops_; }
  const std::vector<std::size_t>& crossings() const { return crossings_; }
  const Eigen::Vector2d& position(std::size_t node) const { return nodes_[node].position; }
  /// How far right of the middle a robot drives between two neighbouring nodes.
  double lane_m(std::size_t from, std::size_t to) const;

  /// Shortest ways from a node: the distance of every node, and the node before it on the way.
  struct Ways {
    std::vector<double> distance_m;
    std::vector<std::size_t> before;
  };
  Ways ways_from(std::size_t node) const;
  /// The nodes of a way, the first and the last one included.
  static std::vector<std::size_t> way_to(const Ways& ways, std::size_t node);

 private:
  struct Link {
    std::size_t to = 0;
    double length_m = 0;
    double lane_m = 0;
  };
  struct Node {
    Eigen::Vector2d position;
    std::vector<Link> links;
  };
  std::size_t add_node(const Eigen::Vector2d& position, const std::vector<std::size_t>& corridors);
  void link_along(const FloorLayout& layout);

  std::vector<Node> nodes_;
  std::vector<std::vector<std::size_t>> nodes_of_corridor_;  ///< by cell
  std::vector<std::size_t> crossings_;
  std::vector<FloorStop> stops_;
};

}  // namespace isthmus
