#include "tools/simulate/campaigns/confidence/confidence.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

#include "relations/confidence.hpp"
#include "server/engine/engine.hpp"
#include "server/wire/message/message.hpp"
#include "tools/simulate/truth/true_patches.hpp"

namespace isthmus {
void ConfidenceTally::add(const Eigen::Vector3d& error, const Eigen::Matrix3d& covariance) {
  for (Eigen::Index i = 0; i < 3; ++i) {
    if (std::abs(error[i]) <= 1.96 * std::sqrt(covariance(i, i))) ++within_[static_cast<std::size_t>(i)];
  }
  nees_.push_back(error.dot(covariance.ldlt().solve(error)) / 3);
  error_m_ += error.head<2>().norm();
  error_rad_ += std::abs(error[2]);
}

void ConfidenceTally::add(const ConfidenceTally& other) {
  nees_.insert(nees_.end(), other.nees_.begin(), other.nees_.end());
  for (std::size_t i = 0; i < 3; ++i) within_[i] += other.within_[i];
  error_m_ += other.error_m_;
  error_rad_ += other.error_rad_;
}

Confidence ConfidenceTally::result() const {
  Confidence confidence;
  confidence.pairs = nees_.size();
  if (nees_.empty()) return confidence;
  const auto n = static_cast<double>(nees_.size());
  for (std::size_t i = 0; i < 3; ++i) confidence.within_95[i] = static_cast<double>(within_[i]) / n;
  for (const double nees : nees_) confidence.mean_nees += nees / n;
  std::vector<double> sorted = nees_;
  std::ranges::sort(sorted);
  confidence.median_nees = sorted[sorted.size() / 2];
  confidence.mean_error_m = error_m_ / n;
  confidence.mean_error_rad = error_rad_ / n;
  return confidence;
}

MapConfidence judge_confidence(const MapCopy& map, const std::vector<RobotTruth>& truth,
                               const EngineOptions& options, const MountSurvey& survey,
                               std::size_t observers) {
  MapConfidence confidence;
  const auto true_patch = true_patches(map, truth);
  const std::size_t stride = std::max<std::size_t>(1, map.patches.size() / observers);
  for (std::size_t i = 0; i < map.patches.size(); i += stride) {
    if (!true_patch[i]) continue;
    const PatchId a = map.patches[i]->id;
    std::vector<PatchId> others;
    for (const PatchId b : map.graph.patches_of(map.graph.island(a))) {
      const auto& other = true_patch[static_cast<std::size_t>(b.value)];
      if (b != a && other && other->stretch == true_patch[i]->stretch) others.push_back(b);
    }
    const auto covariances = exact_relative_covariances(map.graph, map.poses, a, others);
    if (covariances.size() != others.size()) ++confidence.undetermined;
    for (std::size_t k = 0; k < covariances.size(); ++k) {
      const auto b = static_cast<std::size_t>(others[k].value);
      const Pose estimate = ominus(map.poses[b], map.poses[i]);
      const Pose actual = ominus(true_patch[b]->world_from_patch, true_patch[i]->world_from_patch);
      const Eigen::Vector3d error = wrapped_difference(estimate, actual);
      const Eigen::Matrix3d covariance =
          covariances[k] + mount_covariance(estimate, map.patches[i]->robot, map.patches[b]->robot, survey);
      confidence.island.add(error, covariance);
      const bool near = std::hypot(estimate.x, estimate.y) <= options.surroundings.reach_m;
      if (near && well_determined(covariances[k], options.local_map)) confidence.local.add(error, covariance);
    }
  }
  return confidence;
}

MapCopy map_events(const std::vector<Event>& events, const Configuration& configuration) {
  Engine engine(configuration);
  for (const Event& event : events) {
    const Message message = encode(event);
    const Decoded heard = decode({}, message.channel, message.bytes, message.utime);
    if (heard.event) engine.handle(*heard.event);
  }
  engine.finish();
  return engine.copy();
}

}  // namespace isthmus
