#include "server/engine/places/consistency.hpp"

#include <algorithm>
#include <cmath>

namespace isthmus {
namespace {

double position_variance(const Eigen::Matrix3d& covariance) {
  return covariance.topLeftCorner<2, 2>().trace();
}

double squared(double value) { return value * value; }

/// Branch and bound for the largest clique that holds one member.
class CliqueSearch {
 public:
  CliqueSearch(const AgreementTable& table, int max_steps) : table_(table), max_steps_(max_steps) {}

  std::vector<std::size_t> with(std::size_t member) {
    std::vector<std::size_t> candidates;
    for (std::size_t i = 0; i < table_.size(); ++i)
      if (i != member && table_.between(i, member) == Agreement::consistent) candidates.push_back(i);
    chosen_ = {member};
    best_ = chosen_;
    extend(candidates);
    std::ranges::sort(best_);
    return best_;
  }

 private:
  void extend(const std::vector<std::size_t>& candidates) {
    if (chosen_.size() > best_.size()) best_ = chosen_;
    for (std::size_t k = 0; k < candidates.size(); ++k) {
      if (chosen_.size() + candidates.size() - k <= best_.size() || ++steps_ > max_steps_) return;
      std::vector<std::size_t> rest;
      for (std::size_t j = k + 1; j < candidates.size(); ++j)
        if (table_.between(candidates[k], candidates[j]) == Agreement::consistent)
          rest.push_back(candidates[j]);
      chosen_.push_back(candidates[k]);
      extend(rest);
      chosen_.pop_back();
    }
  }

  const AgreementTable& table_;
  int max_steps_;
  std::vector<std::size_t> chosen_;
  std::vector<std::size_t> best_;
  int steps_ = 0;
};

}  // namespace

NearbyConfidence::NearbyConfidence(const Map& map, PatchId of, std::size_t max_patches)
    : reference(of),
      covariances(local_relative_covariances(map.graph(), map.manifold().poses(), of, max_patches)) {}

std::optional<Eigen::Matrix3d> NearbyConfidence::of(PatchId patch) const {
  if (patch == reference) return Eigen::Matrix3d::Zero();
  const auto found = covariances.find(patch);
  if (found == covariances.end()) return std::nullopt;
  return found->second;
}

Agreement agreement(const Map& map, const Find& first, const NearbyConfidence& of_anchor,
                    const NearbyConfidence& of_query, const Find& second, const ConsistencyOptions& options) {
  // The other robot may have found the same from its side.
  PatchId anchor = second.anchor;
  PatchId query = second.query;
  Pose anchor_from_query = second.anchor_from_query;
  auto anchors = of_anchor.of(anchor);
  auto queries = of_query.of(query);
  if (!anchors || !queries) {
    std::swap(anchor, query);
    anchor_from_query = inverse(anchor_from_query);
    anchors = of_anchor.of(anchor);
    queries = of_query.of(query);
  }
  if (!anchors || !queries) return Agreement::unrelated;
  const Manifold& manifold = map.manifold();
  const Pose first_from_second_anchor = manifold.relative_pose(first.anchor, anchor);
  const Pose first_from_second_query = manifold.relative_pose(first.query, query);
  const Pose round =
      ominus(first_from_second_anchor * anchor_from_query, first.anchor_from_query * first_from_second_query);
  // What is turned at one end moves the other.
  const double way_m = std::hypot(first_from_second_query.x, first_from_second_query.y);
  const double lever_m = std::hypot(anchor_from_query.x, anchor_from_query.y);
  const CommonOptions& its = options.common;
  const double find_sigma_rad = its.yaw_rad(options.find_sigma_m);
  const double yaw_variance = 2 * squared(find_sigma_rad) + (*anchors)(2, 2) + (*queries)(2, 2);
  const double variance = 2 * squared(options.find_sigma_m) + position_variance(*anchors) +
                          position_variance(*queries) + (*anchors)(2, 2) * squared(lever_m) +
                          squared(find_sigma_rad * way_m);
  const double off_m = std::hypot(round.x, round.y);
  const double off_rad = std::abs(round.yaw);
  const bool closes = its.is_within(round, its.apart_m) &&
                      squared(off_m) < its.surprise.bound(1) * variance &&
                      squared(off_rad) < its.surprise.bound(1) * yaw_variance;
  return closes ? Agreement::consistent : Agreement::inconsistent;
}

void AgreementTable::add(std::vector<Agreement> with_earlier) {
  with_earlier.resize(rows_.size(), Agreement::unrelated);
  rows_.push_back(std::move(with_earlier));
}

void AgreementTable::replace(std::size_t member, const std::vector<Agreement>& with_others) {
  for (std::size_t i = 0; i < rows_.size(); ++i)
    if (i != member) rows_[std::max(i, member)][std::min(i, member)] = with_others[i];
}

void AgreementTable::remove(const std::vector<bool>& gone) {
  std::vector<std::vector<Agreement>> kept;
  for (std::size_t i = 0; i < rows_.size(); ++i) {
    if (gone[i]) continue;
    std::vector<Agreement> row;
    for (std::size_t j = 0; j < i; ++j)
      if (!gone[j]) row.push_back(rows_[i][j]);
    kept.push_back(std::move(row));
  }
  rows_ = std::move(kept);
}

Agreement AgreementTable::between(std::size_t a, std::size_t b) const {
  if (a == b) return Agreement::consistent;
  return a > b ? rows_[a][b] : rows_[b][a];
}

std::vector<std::size_t> AgreementTable::largest_consistent_with(std::size_t member,
                                                                 const ConsistencyOptions& options) const {
  return CliqueSearch(*this, options.max_steps).with(member);
}

std::vector<std::size_t> AgreementTable::rivals_of(const std::vector<std::size_t>& set) const {
  std::vector<std::size_t> rivals;
  for (std::size_t i = 0; i < rows_.size(); ++i) {
    if (std::ranges::find(set, i) != set.end()) continue;
    const auto against = std::ranges::count_if(
        set, [&](std::size_t member) { return between(i, member) == Agreement::inconsistent; });
    if (2 * static_cast<std::size_t>(against) > set.size()) rivals.push_back(i);
  }
  return rivals;
}

}  // namespace isthmus
