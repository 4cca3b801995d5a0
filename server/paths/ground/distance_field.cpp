#include "server/paths/ground/distance_field.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

namespace isthmus {
namespace {

int squared(const Cell& a, const Cell& b) { return (a.x - b.x) * (a.x - b.x) + (a.y - b.y) * (a.y - b.y); }

/// Nodes to look at, by their squared distance in cells.
class Brushfire {
 public:
  using Counts = std::function<bool(NodeId, const Cell&)>;

  Brushfire(const GroundWindow& ground, int max_squared, const Counts& counts)
      : ground_(ground),
        counts_(counts),
        least_(ground.size(), std::numeric_limits<int>::max()),
        waiting_(static_cast<std::size_t>(max_squared) + 1) {}

  void light(const Source& source) {
    const int distance = squared(ground_.cell(source.node), source.cell);
    int& least = least_[static_cast<std::size_t>(source.node)];
    if (distance >= least || distance >= static_cast<int>(waiting_.size())) return;
    least = distance;
    waiting_[static_cast<std::size_t>(distance)].push_back(source);
  }

  void burn() {
    for (std::size_t distance = 0; distance < waiting_.size(); ++distance) {
      for (std::size_t i = 0; i < waiting_[distance].size();
           ++i) {  // what is lit lies farther out, or is nearer
        const Source source = waiting_[distance][i];
        if (least_[static_cast<std::size_t>(source.node)] != static_cast<int>(distance)) continue;
        visit_beside(ground_.cell(source.node), [&](const Cell& beside) {
          if (squared(beside, source.cell) <= static_cast<int>(distance)) return;
          const NodeId next = ground_.step(source.node, beside);
          if (next >= 0 && (!counts_ || counts_(next, source.cell))) light({next, source.cell});
        });
      }
    }
  }

  const std::vector<int>& least() const { return least_; }

 private:
  const GroundWindow& ground_;
  const Counts& counts_;
  std::vector<int> least_;
  std::vector<std::vector<Source>> waiting_;
};

}  // namespace

std::vector<float> distances_m(const GroundWindow& ground, std::span<const Source> sources, double reach_m,
                               const std::function<bool(NodeId, const Cell&)>& counts) {
  constexpr double half_diagonal = 0.5 * std::numbers::sqrt2;
  const double reach_cells = reach_m / ground_cell_m + half_diagonal;
  Brushfire fire(ground, static_cast<int>(reach_cells * reach_cells), counts);
  for (const Source& source : sources) fire.light(source);
  fire.burn();
  std::vector<float> distances;
  distances.reserve(ground.size());
  for (const int least : fire.least()) {
    const double cells = std::max(0.0, std::sqrt(static_cast<double>(least)) - half_diagonal);
    distances.push_back(static_cast<float>(std::min(reach_m, cells * ground_cell_m)));
  }
  return distances;
}

}  // namespace isthmus
