#include "relations/weakest_cut.hpp"

#include <algorithm>
#include <boost/graph/adjacency_list.hpp>
#include <boost/graph/boykov_kolmogorov_max_flow.hpp>
#include <limits>
#include <map>

namespace isthmus {
namespace {

using Traits = boost::adjacency_list_traits<boost::vecS, boost::vecS, boost::bidirectionalS>;
using FlowGraph = boost::adjacency_list<
    boost::vecS, boost::vecS, boost::bidirectionalS,
    boost::property<boost::vertex_color_t, boost::default_color_type,
                    boost::property<boost::vertex_distance_t, long,
                                    boost::property<boost::vertex_predecessor_t, Traits::edge_descriptor>>>,
    boost::property<boost::edge_capacity_t, double,
                    boost::property<boost::edge_residual_capacity_t, double,
                                    boost::property<boost::edge_reverse_t, Traits::edge_descriptor>>>>;
using Vertex = Traits::vertex_descriptor;

/// Patches and placings as vertices, links as edges of either direction.
class CutGraph {
 public:
  explicit CutGraph(std::span<const UncertainLink> links)
      : source_(add_vertex(graph_)), sink_(add_vertex(graph_)) {
    for (const UncertainLink& link : links)
      if (link.of_placing) place(link);
    for (auto& [placed, placing] : placings_) {
      placing.vertex = add_vertex(graph_);
      join(placing.vertex, patch(placed), placing.log_odds);
    }
    for (const UncertainLink& link : links) {
      const Vertex a = patch(link.a);
      const Vertex b = patch(link.b);
      join(a, link.of_placing ? placings_.at(link.b).vertex : b, link.log_odds);
    }
  }

  bool knows(PatchId id) const { return patches_.contains(id); }
  void begin_at(PatchId id) { join(source_, patch(id), endless); }
  void end_at(PatchId id) { join(patch(id), sink_, endless); }

  double cut() { return boykov_kolmogorov_max_flow(graph_, source_, sink_); }
  /// After the cut: whether a patch is on the side of the end.
  bool is_beyond(PatchId id) const {
    return get(boost::vertex_color, graph_, patches_.at(id)) != boost::black_color;
  }
  std::vector<PatchId> beyond() const {
    std::vector<PatchId> found;
    for (const auto& [id, vertex] : patches_)
      if (is_beyond(id)) found.push_back(id);
    return found;
  }

 private:
  struct Placing {
    Vertex vertex;
    double log_odds;  ///< of the least sure of its links
  };

  static constexpr double endless = 1e9;

  Vertex patch(PatchId id) {
    const auto [at, is_new] = patches_.try_emplace(id);
    if (is_new) at->second = add_vertex(graph_);
    return at->second;
  }
  void place(const UncertainLink& link) {
    const auto [at, is_new] = placings_.try_emplace(link.b, Placing{Vertex{}, link.log_odds});
    at->second.log_odds = std::min(at->second.log_odds, link.log_odds);
  }
  void join(Vertex one, Vertex other, double capacity) {
    const auto there = add_edge(one, other, graph_).first;
    const auto back = add_edge(other, one, graph_).first;
    put(boost::edge_capacity, graph_, there, capacity);
    put(boost::edge_capacity, graph_, back, capacity);
    put(boost::edge_reverse, graph_, there, back);
    put(boost::edge_reverse, graph_, back, there);
  }

  FlowGraph graph_;
  std::map<PatchId, Vertex> patches_;
  std::map<PatchId, Placing> placings_;
  Vertex source_;
  Vertex sink_;
};

}  // namespace

std::optional<WeakestCut> weakest_cut(std::span<const UncertainLink> links, std::span<const PatchId> from,
                                      std::span<const PatchId> to) {
  const auto is_of = [](std::span<const PatchId> set, PatchId id) {
    return std::ranges::find(set, id) != set.end();
  };
  CutGraph graph(links);
  for (const std::span<const PatchId> set : {from, to})
    if (set.empty() || !std::ranges::all_of(set, [&](PatchId id) { return graph.knows(id); }))
      return std::nullopt;
  if (std::ranges::any_of(from, [&](PatchId id) { return is_of(to, id); })) return std::nullopt;
  for (const PatchId id : from) graph.begin_at(id);
  for (const PatchId id : to) graph.end_at(id);
  WeakestCut found;
  found.log_odds = graph.cut();
  for (const UncertainLink& link : links)
    if (graph.is_beyond(link.a) != graph.is_beyond(link.b)) found.relations.push_back(link.relation);
  if (found.relations.empty()) return std::nullopt;
  std::ranges::sort(found.relations);
  found.beyond = graph.beyond();
  return found;
}

}  // namespace isthmus
