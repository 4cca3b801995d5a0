#include "server/engine/map/fit_job.hpp"

#include <algorithm>
#include <cmath>

#include "relations/confidence.hpp"
#include "relations/fit.hpp"
#include "server/engine/map/dependencies.hpp"
#include "server/engine/map/drift.hpp"

namespace isthmus {
namespace {

constexpr std::size_t max_abandoned = 4;  // so many threads at most are for nothing

// Log-odds that the loop is open for another reason than by the drift of the whole way, or by a slip that
// nobody knows the place of.
double log_odds_of_blame(const FitJob::LoopQuestion& question, std::span<const Pose> poses,
                         const Eigen::Matrix3d& covariance) {
  const OpenLoop& loop = question.loop;
  const Pose &of_a = poses[index(question.a)], &of_b = poses[index(question.b)];
  const bool a_is_first = std::ranges::find(loop.first, question.a) != loop.first.end();
  const Pose moved = a_is_first ? loop.first_from_second : inverse(loop.first_from_second);
  const Pose found = ominus(moved * of_b, of_a), mapped = ominus(of_b, of_a);
  return -(question.may_have_slipped ? revisit_log_odds(found, mapped, covariance, loop.way_m, question.drift)
                                     : drift_log_odds(found, mapped, covariance, loop.way_m, question.drift));
}

// `poses` are those before; the result's those of the fit with the loop, which costs so much.
void answer(const FitJob::LoopQuestion& question, const RelationGraph& graph, std::span<const Pose> poses,
            double cost, FitJob::Result& result) {
  const PatchId others[] = {question.b};
  const auto covariances = exact_relative_covariances(question.before, poses, question.a, others);
  if (covariances.empty()) return;
  result.covariance = covariances.front();
  result.rests_on = closures_between(question.before, question.a, question.b);
  std::optional<Blame> found = blame({question.loop, question.before, poses, graph, cost,
                                      log_odds_of_blame(question, poses, *result.covariance),
                                      log_search_window(question.loop.way_m, question.drift), question.reach},
                                     question.weak_links);
  if (!found) return;
  result.blamed = std::move(found->wrong);
  result.blamed_closure = found->closure;
  result.blamed_log_odds = found->none_log_odds;
  result.poses = std::move(found->poses);
}

FitJob::Result fit_copy(const RelationGraph& graph, const std::vector<Pose>& poses, IslandId island,
                        const std::optional<FitJob::LoopQuestion>& question) {
  FitJob::Result result;
  result.patches = graph.patches_of(island);
  result.poses = poses;
  const FitReport report = fit_island(graph, island, result.poses);
  result.ok = report.ok;
  if (result.ok && question) answer(*question, graph, poses, report.cost_after, result);
  return result;
}

}  // namespace

FitJob::FitJob(const Map& map, IslandId island, std::int64_t now_utime, std::optional<LoopQuestion> question,
               const MapFitOptions& options)
    : island_(island) {
  const std::int64_t patches = std::ranges::ssize(map.graph().patches_of(island));
  events_left_ = patches;
  due_utime_ = now_utime + patches * options.us_per_patch;
  std::vector<Pose> poses(map.manifold().poses().begin(), map.manifold().poses().end());
  result_ = std::async(std::launch::async,
                       [graph = map.graph(), poses = std::move(poses), island,
                        question = std::move(question)] { return fit_copy(graph, poses, island, question); });
}

bool FitJob::advance(std::int64_t now_utime) {
  --events_left_;
  return events_left_ <= 0 || now_utime >= due_utime_;
}

void AbandonedFits::add(std::unique_ptr<FitJob> job) {
  jobs_.push_back(std::move(job));
  if (jobs_.size() > max_abandoned) jobs_.pop_front();
}

void AbandonedFits::let_go() {
  std::erase_if(jobs_, [](const auto& job) { return job->ended(); });
}

}  // namespace isthmus
