#include "server/engine/map/fit_job.hpp"

#include "relations/confidence.hpp"
#include "relations/fit.hpp"

namespace isthmus {
namespace {

constexpr std::size_t max_abandoned = 4;  // so many threads at most are for nothing

FitJob::Result fit_copy(const RelationGraph& graph, std::vector<Pose> poses, IslandId island,
                        const std::optional<FitJob::ConfidenceQuestion>& question) {
  FitJob::Result result;
  result.patches = graph.patches_of(island);
  if (question) {
    const PatchId others[] = {question->b};
    const auto covariances = exact_relative_covariances(question->graph, poses, question->a, others);
    if (!covariances.empty()) result.covariance = covariances.front();
  }
  result.poses = std::move(poses);
  result.ok = fit_island(graph, island, result.poses).ok;
  return result;
}

}  // namespace

FitJob::FitJob(const Map& map, IslandId island, std::int64_t now_utime,
               std::optional<ConfidenceQuestion> question, const MapFitOptions& options)
    : island_(island) {
  const auto patches = static_cast<std::int64_t>(map.manifold().size());
  events_left_ = patches;
  due_utime_ = now_utime + patches * options.us_per_patch;
  std::vector<Pose> poses(map.manifold().poses().begin(), map.manifold().poses().end());
  result_ = std::async(std::launch::async, [graph = map.graph(), poses = std::move(poses), island,
                                            question = std::move(question)]() mutable {
    return fit_copy(graph, std::move(poses), island, question);
  });
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
