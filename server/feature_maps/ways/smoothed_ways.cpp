#include "server/feature_maps/ways/smoothed_ways.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <utility>

#include "relations/block_cholesky.hpp"
#include "relations/relation.hpp"
#include "server/features/state/measurement.hpp"

namespace isthmus {
namespace {

/// Fits with views as they are, before what does not fit counts for less: the way comes from far where a loop
/// has closed since.
constexpr int plain_fits = 3;
constexpr int most_fits = 30;
constexpr double settled = 1e-3;  // m, rad
/// Of a step, m² and rad²: no step is known better.
constexpr double least_variance = 1e-8;

class WaysFit {
 public:
  WaysFit(std::span<const std::span<const Stop>> ways, const FeatureState& map)
      : ways_(ways), map_{map.form, map.robots, map.features, {}, map.next_id} {
    map_.robots.push_back({{}, own_offset});
    map_.robots.push_back({{}, other_offset});
    for (const std::span<const Stop> way : ways) {
      first_.push_back(poses_.size());
      for (const Stop& stop : way) poses_.push_back(stop.map_from_robot);
    }
  }

  std::vector<std::vector<Pose>> run() {
    BlockCholesky<3> information(static_cast<int>(poses_.size()), related_stops());
    for (int fit = 0; fit < most_fits; ++fit) {
      information.clear();
      pull_.assign(poses_.size(), Eigen::Vector3d::Zero());
      information_ = &information;
      for (std::size_t way = 0; way < ways_.size(); ++way)
        for (std::size_t i = 0; i < ways_[way].size(); ++i) add_stop(way, i, fit >= plain_fits);
      if (!all_finite(pull_)) return as_filtered();
      information.factor();
      information.solve(pull_);  // where nothing tells, it stays
      if (!all_finite(pull_)) return as_filtered();
      double most = 0;
      for (std::size_t i = 0; i < poses_.size(); ++i) {
        poses_[i] = to_pose(to_vector(poses_[i]) + pull_[i]);
        most = std::max(most, pull_[i].cwiseAbs().maxCoeff());
      }
      if (fit >= plain_fits && most < settled) break;
    }
    std::vector<std::vector<Pose>> fitted;
    for (std::size_t way = 0; way < ways_.size(); ++way) {
      const auto begin = poses_.begin() + static_cast<std::ptrdiff_t>(first_[way]);
      fitted.emplace_back(begin, begin + static_cast<std::ptrdiff_t>(ways_[way].size()));
    }
    return fitted;
  }

 private:
  // No other errors of the map begin there.
  static constexpr int own_offset = -1;
  static constexpr int other_offset = -2;

  static bool all_finite(const std::vector<Eigen::Vector3d>& pulls) {
    return std::ranges::all_of(pulls, [](const Eigen::Vector3d& pull) { return pull.allFinite(); });
  }

  std::vector<std::pair<int, int>> related_stops() const {
    std::vector<std::pair<int, int>> pairs;
    for (std::size_t way = 0; way < ways_.size(); ++way) {
      for (std::size_t i = 0; i < ways_[way].size(); ++i) {
        const auto at = static_cast<int>(first_[way] + i);
        if (i > 0) pairs.emplace_back(at - 1, at);
        for (const RobotView& view : ways_[way][i].robots)
          if (is_here(view)) pairs.emplace_back(at, static_cast<int>(place_of(view)));
      }
    }
    return pairs;
  }

  bool is_here(const RobotView& view) const {
    const auto way = static_cast<std::size_t>(view.way);
    return way < ways_.size() && static_cast<std::size_t>(view.stop) < ways_[way].size();
  }
  std::size_t place_of(const RobotView& view) const {
    return first_[static_cast<std::size_t>(view.way)] + static_cast<std::size_t>(view.stop);
  }

  std::vector<std::vector<Pose>> as_filtered() const {
    std::vector<std::vector<Pose>> poses;
    for (const std::span<const Stop> way : ways_) {
      poses.emplace_back();
      for (const Stop& stop : way) poses.back().push_back(stop.map_from_robot);
    }
    return poses;
  }

  void add_stop(std::size_t way, std::size_t i, bool robust) {
    const Stop& stop = ways_[way][i];
    const std::size_t at = first_[way] + i;
    if (i > 0) add_step(at, stop.from_last);
    map_.robots[own()].map_from_robot = poses_[at];
    for (const FeatureView& view : stop.views) {
      const auto index = index_of(map_, view.id);
      if (!index) continue;  // it has gone
      const auto measured =
          measure_feature(map_, *index, static_cast<int>(own()), view.seen, !view.line_alone);
      if (measured) add(*measured, at, at, robust);
    }
    for (const RobotView& view : stop.robots) {
      if (!is_here(view)) continue;  // it is on another map
      map_.robots[own() + 1].map_from_robot = poses_[place_of(view)];
      RelativeSighting seen = view.seen;
      seen.observer = static_cast<int>(own());
      seen.target = seen.observer + 1;
      const auto measured = measure_robot(map_, seen);
      if (measured) add(*measured, at, place_of(view), robust);
    }
  }

  void add_step(std::size_t at, const OdometryPath& step) {
    const Eigen::Matrix3d information =
        (step.covariance + least_variance * Eigen::Matrix3d::Identity()).inverse();
    const Eigen::Vector3d residual =
        wrapped_difference(step.start_from_end, ominus(poses_[at], poses_[at - 1]));
    const OminusJacobians by = ominus_jacobians(poses_[at], poses_[at - 1]);
    const auto row = static_cast<int>(at);
    information_->add_diagonal(row, by.by_q.transpose() * information * by.by_q);
    information_->add_diagonal(row - 1, by.by_pi.transpose() * information * by.by_pi);
    information_->add(row, row - 1, by.by_q.transpose() * information * by.by_pi);
    pull_[at] += by.by_q.transpose() * information * residual;
    pull_[at - 1] += by.by_pi.transpose() * information * residual;
  }

  /// What was measured from a stop, `other` being where the other robot was.
  void add(const LinearMeasurement& measured, std::size_t at, std::size_t other, bool robust) {
    const Eigen::LLT<LocalMatrix> noise(measured.noise);
    if (noise.info() != Eigen::Success) return;
    const double squared = measured.residual.dot(noise.solve(measured.residual));
    const double scale = robust ? std::sqrt(static_cast<double>(measured.residual.size())) : 0;
    const double weight = robust_weight(squared, scale);
    for (const LinearMeasurement::Block& block : measured.blocks) {
      if (block.offset >= 0) continue;  // the map is taken as it is
      const std::size_t row = block.offset == own_offset ? at : other;
      pull_[row] += weight * block.by.transpose() * noise.solve(measured.residual);
      information_->add_diagonal(static_cast<int>(row),
                                 weight * block.by.transpose() * noise.solve(block.by));
      for (const LinearMeasurement::Block& with : measured.blocks)
        if (block.offset == own_offset && with.offset == other_offset)
          information_->add(static_cast<int>(at), static_cast<int>(other),
                            weight * block.by.transpose() * noise.solve(with.by));
    }
  }

  std::size_t own() const { return map_.robots.size() - 2; }

  std::span<const std::span<const Stop>> ways_;
  FeatureState map_;  ///< the robot that sees, and one that is seen, are its last two
  std::vector<std::size_t> first_;
  std::vector<Pose> poses_;                  ///< way by way
  BlockCholesky<3>* information_ = nullptr;  ///< of the fit that runs
  std::vector<Eigen::Vector3d> pull_;        ///< by stop; solved, the errors
};

}  // namespace

std::vector<std::vector<Pose>> smoothed_stops(std::span<const std::span<const Stop>> ways,
                                              const FeatureState& map) {
  return WaysFit(ways, map).run();
}

}  // namespace isthmus
