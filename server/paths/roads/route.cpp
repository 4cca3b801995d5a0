#include "server/paths/roads/route.hpp"

#include <algorithm>
#include <functional>
#include <queue>
#include <tuple>
#include <utility>

#include "server/paths/ground/no_way.hpp"

namespace isthmus {
namespace {

/// How far the search looks: farther out a straight way gets corners that pulling it taut takes out again.
constexpr float sight_m = 10;

class Search {
 public:
  Search(const Roadmap& roadmap, NodeId from, NodeId to)
      : roadmap_(roadmap),
        from_(from),
        to_(to),
        left_m_(roadmap.regions().left_m(roadmap.square(from), roadmap.square(to))),
        cost_(roadmap.squares(), no_way_m),
        parent_(roadmap.squares(), -1),
        closed_(roadmap.squares(), 0) {}

  bool run(std::size_t max_steps) {
    if (left_m_.empty()) return false;
    const SquareId start = roadmap_.square(from_), goal = roadmap_.square(to_);
    open(start, start, 0);
    for (std::size_t steps = 0; !waiting_.empty() && steps < max_steps; ++steps) {
      const auto [total, cost, square] = waiting_.top();
      waiting_.pop();
      if (closed_[at(square)] || cost > cost_[at(square)]) continue;
      settle(square);
      if (square == goal) return true;
      const SquareId parent = parent_[at(square)];
      for (const SquareId next : roadmap_.beside(square))
        if (!closed_[at(next)]) open(next, parent, cost_[at(parent)] + distance(parent, next));
    }
    return false;
  }

  /// From start to goal; neighbours may stand where none sees the other.
  std::vector<SquareId> squares() const {
    std::vector<SquareId> found{roadmap_.square(to_)};
    while (found.back() != roadmap_.square(from_)) found.push_back(parent_[at(found.back())]);
    std::reverse(found.begin(), found.end());
    return found;
  }

  NodeId node(SquareId square) const {
    if (square == roadmap_.square(from_)) return from_;
    return square == roadmap_.square(to_) ? to_ : roadmap_.middle(square);
  }

 private:
  static std::size_t at(SquareId square) { return static_cast<std::size_t>(square); }

  float distance(SquareId a, SquareId b) const {
    const Ground& ground = roadmap_.ground();
    return static_cast<float>((ground.centre(node(a)) - ground.centre(node(b))).norm());
  }

  void open(SquareId square, SquareId parent, float cost) {
    const float left_m = left_m_[at(roadmap_.regions().of(square))];
    if (!(cost < cost_[at(square)]) || left_m == no_way_m) return;
    cost_[at(square)] = cost;
    parent_[at(square)] = parent;
    waiting_.emplace(cost + std::max(left_m, distance(square, roadmap_.square(to_))), cost, square);
  }

  /// It was hoped that the square is seen from its parent; where it is not, it is reached from beside.
  void settle(SquareId square) {
    closed_[at(square)] = 1;
    const SquareId hoped = parent_[at(square)];
    if (hoped == square) return;
    if (distance(hoped, square) <= sight_m && roadmap_.sees(node(hoped), node(square))) return;
    cost_[at(square)] = no_way_m;
    for (const SquareId beside : roadmap_.beside(square)) {
      if (!closed_[at(beside)]) continue;
      const float cost = cost_[at(beside)] + distance(beside, square);
      if (!(cost < cost_[at(square)])) continue;
      cost_[at(square)] = cost;
      parent_[at(square)] = beside;
    }
  }

  using Entry = std::tuple<float, float, SquareId>;  // cost with what is left at least, cost, square

  const Roadmap& roadmap_;
  const NodeId from_, to_;
  std::vector<float> left_m_;  // by region: see Regions
  std::vector<float> cost_;
  std::vector<SquareId> parent_;
  std::vector<std::uint8_t> closed_;
  std::priority_queue<Entry, std::vector<Entry>, std::greater<>> waiting_;
};

/// From cell to cell within two squares, step by step.
std::vector<NodeId> bridge(const Roadmap& roadmap, NodeId from, NodeId to) {
  const SquareId a = roadmap.square(from), b = roadmap.square(to);
  std::vector<std::pair<NodeId, std::size_t>> reached{{to, 0}};  // and from which
  for (std::size_t i = 0; i < reached.size(); ++i) {
    if (reached[i].first == from) {
      std::vector<NodeId> way;
      for (std::size_t j = i; j != 0; j = reached[j].second) way.push_back(reached[reached[j].second].first);
      return way;
    }
    visit_beside(roadmap.ground().cell(reached[i].first), [&](const Cell& beside) {
      const NodeId next = roadmap.ground().step(reached[i].first, beside);
      if (next < 0 || (roadmap.square(next) != a && roadmap.square(next) != b)) return;
      const bool known =
          std::any_of(reached.begin(), reached.end(), [next](const auto& one) { return one.first == next; });
      if (!known) reached.emplace_back(next, i);
    });
  }
  return {};
}

}  // namespace

std::optional<std::vector<NodeId>> find_route(const Roadmap& roadmap, NodeId from, NodeId to,
                                              std::size_t max_steps) {
  Search search(roadmap, from, to);
  if (!search.run(max_steps)) return std::nullopt;
  std::vector<NodeId> nodes{from};
  const auto go_to = [&](NodeId next) {
    if (roadmap.sees(nodes.back(), next)) {
      nodes.push_back(next);
      return true;
    }
    const std::vector<NodeId> between = bridge(roadmap, nodes.back(), next);
    nodes.insert(nodes.end(), between.begin(), between.end());
    return !between.empty();
  };
  for (const SquareId square : search.squares())
    if (!go_to(search.node(square))) return std::nullopt;
  if (!go_to(to)) return std::nullopt;
  return nodes;
}

std::vector<float> costs_from(const Roadmap& roadmap, NodeId from) {
  return roadmap.graph().lengths_from(roadmap.square(from));
}

}  // namespace isthmus
