#include "tools/evaluate/pose_graph.hpp"

#include <ctime>

#include "relations/fit.hpp"
#include "tools/evaluate/form_graph.hpp"
#include "tools/text/lines.hpp"

namespace isthmus {
namespace {

double cost_f(const RelationGraph& graph, const std::vector<Pose>& poses) {
  double f = 0;
  for (const auto& [id, relation] : graph.relations()) {
    const Pose& a = poses[static_cast<std::size_t>(relation.a.value)];
    const Pose& b = poses[static_cast<std::size_t>(relation.b.value)];
    f += 2 * cost(relation.measurement, ominus(b, a));
  }
  return f;
}

}  // namespace

PoseGraphFit fit_pose_graph(const std::string& file) {
  FormGraph input = form_graph(read_g2o(file));
  if (input.graph.relations().empty()) throw FileError(file, 0, "no EDGE_SE2 line");
  PoseGraphFit result;
  result.patches = input.graph.patch_count();
  result.relations = input.graph.relations().size();
  result.f_before = cost_f(input.graph, input.poses);
  FitOptions options;
  options.chordal_start = true;
  options.max_iterations = 100;
  const std::clock_t start = std::clock();
  for (const auto& island : input.graph.islands()) {
    const FitReport report = fit_island(input.graph, island.front(), input.poses, options);
    result.iterations += report.iterations;
    if (!report.ok && result.failure.empty())
      result.failure = file + ": no solution for the island of patch " +
                       std::to_string(island.front().value) + ": " + report.message;
    ++result.islands;
  }
  result.cpu_s = static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC;
  result.f_after = cost_f(input.graph, input.poses);
  return result;
}

}  // namespace isthmus
