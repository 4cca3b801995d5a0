#include "server/paths/ground/gaps.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <unordered_set>

namespace isthmus {
namespace {

std::uint64_t key(const Cell& cell) {
  return (static_cast<std::uint64_t>(static_cast<std::uint32_t>(cell.y)) << 32U) |
         static_cast<std::uint32_t>(cell.x);
}

class GapSearch {
 public:
  explicit GapSearch(const GroundWindow& ground) : ground_(ground) {}

  /// From a node's cell over the unseen ones beside it.
  void look_around(NodeId node) {
    if (ground_.occupied(node)) return;
    visit_beside(ground_.cell(node), [&](const Cell& beside) {
      if (is_unseen(beside) && looked_.insert(key(beside)).second) flood(beside, ground_.leader(node));
    });
  }

  std::vector<GapCell> take() {
    std::sort(gaps_.begin(), gaps_.end(), [](const GapCell& a, const GapCell& b) {
      return a.cell.y != b.cell.y ? a.cell.y < b.cell.y : a.cell.x < b.cell.x;
    });
    return std::move(gaps_);
  }

 private:
  bool is_unseen(const Cell& cell) const {
    const auto [first, last] = ground_.at(cell);
    return first == last;
  }

  /// Whether there is free ground, of one layer.
  bool is_rim(const Cell& cell) const {
    const NodeId node = ground_.only(cell);
    return node >= 0 && !ground_.occupied(node);
  }

  /// What was looked at before, and is beside this, is part of something larger: a gap is looked at as a
  /// whole.
  void flood(const Cell& start, PatchId leader) {
    std::vector<Cell> cells{start};
    Cell low = start, high = start;
    bool is_gap = true;
    for (std::size_t i = 0; i < cells.size() && is_gap; ++i) {
      const Cell cell = cells[i];
      low = {std::min(low.x, cell.x), std::min(low.y, cell.y)};
      high = {std::max(high.x, cell.x), std::max(high.y, cell.y)};
      is_gap = ground_cell_m * std::hypot(high.x - low.x + 1, high.y - low.y + 1) < max_gap_m;
      visit_beside(cell, [&](const Cell& beside) {
        if (!is_unseen(beside))
          is_gap = is_gap && is_rim(beside);
        else if (looked_.insert(key(beside)).second)
          cells.push_back(beside);
        else
          is_gap = is_gap && std::ranges::find(cells, beside) != cells.end();
      });
    }
    if (!is_gap) return;
    for (const Cell& cell : cells) gaps_.push_back({cell, leader});
  }

  const GroundWindow& ground_;
  std::unordered_set<std::uint64_t> looked_;
  std::vector<GapCell> gaps_;
};

}  // namespace

std::vector<GapCell> find_gaps(const GroundWindow& ground) {
  GapSearch search(ground);
  for (NodeId node = 0; node < static_cast<NodeId>(ground.size()); ++node) search.look_around(node);
  return search.take();
}

}  // namespace isthmus
