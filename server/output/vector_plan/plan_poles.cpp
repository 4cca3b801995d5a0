#include "server/output/vector_plan/plan_poles.hpp"

#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <map>
#include <set>

namespace isthmus {
namespace {

/// So far before and behind a pole a beam must be seen to have gone through,
constexpr double clear_m = 0.2;
/// within so much of its radius, or of its centre where it is thin.
constexpr double middle_share = 0.5;
constexpr double middle_m = 0.02;

struct Cluster {
  Eigen::Matrix2d information = Eigen::Matrix2d::Zero();
  Eigen::Vector2d weighted = Eigen::Vector2d::Zero();
  double radius_information = 0;
  double radius_weighted = 0;
  std::set<int> views;

  Eigen::Vector2d centre() const { return information.inverse() * weighted; }

  void add(const FeatureSeen& seen) {
    const Feature& pole = seen.observed.feature;
    const Eigen::Matrix2d own = seen.observed.covariance.topLeftCorner<2, 2>().inverse();
    information += own;
    weighted += own * pole.a;
    views.insert(seen.view);
    if (!pole.radius_known) return;
    const double weight = 1 / seen.observed.covariance(2, 2);
    radius_information += weight;
    radius_weighted += weight * pole.radius_m;
  }
};

using Cell = std::pair<int, int>;
Cell cell_of(const Eigen::Vector2d& point, double size_m) {
  return {static_cast<int>(std::floor(point.x() / size_m)), static_cast<int>(std::floor(point.y() / size_m))};
}

/// Clusters of seen poles, each to the nearest within reach.
std::vector<Cluster> clusters(std::span<const FeatureSeen> poles, double reach_m) {
  std::vector<Cluster> found;
  std::map<Cell, std::vector<std::size_t>> cells;
  for (const FeatureSeen& pole : poles) {
    const Eigen::Vector2d& at = pole.observed.feature.a;
    const Cell cell = cell_of(at, reach_m);
    std::size_t best = found.size();
    double least = reach_m;
    for (int dx = -1; dx <= 1; ++dx) {
      for (int dy = -1; dy <= 1; ++dy) {
        const auto here = cells.find({cell.first + dx, cell.second + dy});
        if (here == cells.end()) continue;
        for (const std::size_t i : here->second) {
          const double distance = (found[i].centre() - at).norm();
          if (distance < least) {
            least = distance;
            best = i;
          }
        }
      }
    }
    if (best == found.size()) {
      found.emplace_back();
      cells[cell].push_back(best);
    }
    found[best].add(pole);
  }
  return found;
}

PlanPole pole_of(const Cluster& cluster) {
  PlanPole pole;
  pole.centre = cluster.centre();
  pole.radius_known = cluster.radius_information > 0;
  if (pole.radius_known) pole.radius_m = cluster.radius_weighted / cluster.radius_information;
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d> axes(cluster.information);
  pole.sigma_m = 1 / std::sqrt(axes.eigenvalues()(0));
  pole.views = static_cast<int>(cluster.views.size());
  return pole;
}

/// Whether a beam goes through the middle of the pole and ends behind it.
bool looks_through(const View& view, const PlanPole& pole) {
  const double reach = pole.radius_m + clear_m;
  return std::any_of(view.ends.begin(), view.ends.end(), [&](const Eigen::Vector2d& end) {
    const Eigen::Vector2d beam = end - view.eye, to_pole = pole.centre - view.eye;
    const double length = beam.norm(), along = to_pole.dot(beam) / length;
    if (!(along > reach) || along > length - reach) return false;
    const double aside = std::abs(beam.x() * to_pole.y() - beam.y() * to_pole.x()) / length;
    return aside < std::max(middle_share * pole.radius_m, middle_m);
  });
}

}  // namespace

std::vector<PlanPole> fit_poles(const PlanSource& source, const PlanPoleOptions& options) {
  std::vector<PlanPole> poles;
  for (const Cluster& cluster : clusters(source.poles, options.reach_m)) {
    if (static_cast<int>(cluster.views.size()) < options.min_views) continue;
    const PlanPole pole = pole_of(cluster);
    const auto through = std::count_if(source.views.begin(), source.views.end(),
                                       [&](const View& view) { return looks_through(view, pole); });
    if (through <= pole.views) poles.push_back(pole);
  }
  return poles;
}

}  // namespace isthmus
