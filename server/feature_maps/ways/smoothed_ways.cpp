#include "server/feature_maps/ways/smoothed_ways.hpp"

#include <Eigen/Cholesky>
#include <Eigen/SparseCholesky>
#include <Eigen/SparseCore>
#include <optional>

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
/// Of where the filter had each stop, 1/m² and 1/rad²: it only keeps what sees nothing from having no place.
constexpr double filter_information = 1e-6;

/// Of the errors (x, y, yaw) of poses.
class NormalEquations {
 public:
  explicit NormalEquations(std::size_t poses)
      : size_(3 * static_cast<Eigen::Index>(poses)), gradient_(size_) {
    gradient_.setZero();
  }

  void add(std::size_t row, std::size_t column, const Eigen::Matrix3d& information) {
    for (int i = 0; i < 3; ++i)
      for (int k = 0; k < 3; ++k)
        entries_.emplace_back(3 * static_cast<int>(row) + i, 3 * static_cast<int>(column) + k,
                              information(i, k));
  }
  void add(std::size_t row, const Eigen::Vector3d& pull) {
    gradient_.segment<3>(3 * static_cast<Eigen::Index>(row)) += pull;
  }

  /// The errors; nothing where the equations have no solution.
  std::optional<Eigen::VectorXd> solve() const {
    Eigen::SparseMatrix<double> information(size_, size_);
    information.setFromTriplets(entries_.begin(), entries_.end());
    const Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> factor(information);
    if (factor.info() != Eigen::Success) return std::nullopt;
    Eigen::VectorXd errors = factor.solve(gradient_);
    if (!errors.allFinite()) return std::nullopt;
    return errors;
  }

 private:
  Eigen::Index size_;
  std::vector<Eigen::Triplet<double>> entries_;
  Eigen::VectorXd gradient_;
};

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
    for (int fit = 0; fit < most_fits && !poses_.empty(); ++fit) {
      equations_ = NormalEquations(poses_.size());
      for (std::size_t way = 0; way < ways_.size(); ++way)
        for (std::size_t i = 0; i < ways_[way].size(); ++i) add_stop(way, i, fit >= plain_fits);
      const std::optional<Eigen::VectorXd> errors = equations_.solve();
      if (!errors) return as_filtered();
      for (std::size_t i = 0; i < poses_.size(); ++i) {
        const Eigen::Vector3d error = errors->segment<3>(3 * static_cast<Eigen::Index>(i));
        poses_[i] = to_pose(to_vector(poses_[i]) + error);
      }
      if (fit >= plain_fits && errors->cwiseAbs().maxCoeff() < settled) break;
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
    equations_.add(at, at, filter_information * Eigen::Matrix3d::Identity());
    equations_.add(at, filter_information * wrapped_difference(stop.map_from_robot, poses_[at]));
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
      const auto other = static_cast<std::size_t>(view.way), there = static_cast<std::size_t>(view.stop);
      if (other >= ways_.size() || there >= ways_[other].size()) continue;  // it is on another map
      map_.robots[own() + 1].map_from_robot = poses_[first_[other] + there];
      RelativeSighting seen = view.seen;
      seen.observer = static_cast<int>(own());
      seen.target = seen.observer + 1;
      const auto measured = measure_robot(map_, seen);
      if (measured) add(*measured, at, first_[other] + there, robust);
    }
  }

  void add_step(std::size_t at, const OdometryPath& step) {
    const Eigen::Matrix3d information =
        (step.covariance + least_variance * Eigen::Matrix3d::Identity()).inverse();
    const Eigen::Vector3d residual =
        wrapped_difference(step.start_from_end, ominus(poses_[at], poses_[at - 1]));
    const OminusJacobians by = ominus_jacobians(poses_[at], poses_[at - 1]);
    equations_.add(at, at, by.by_q.transpose() * information * by.by_q);
    equations_.add(at, at - 1, by.by_q.transpose() * information * by.by_pi);
    equations_.add(at - 1, at, by.by_pi.transpose() * information * by.by_q);
    equations_.add(at - 1, at - 1, by.by_pi.transpose() * information * by.by_pi);
    equations_.add(at, by.by_q.transpose() * information * residual);
    equations_.add(at - 1, by.by_pi.transpose() * information * residual);
  }

  /// What was measured from a stop, `other` being where the other robot was.
  void add(const LinearMeasurement& measured, std::size_t at, std::size_t other, bool robust) {
    const Eigen::LLT<LocalMatrix> noise(measured.noise);
    if (noise.info() != Eigen::Success) return;
    const auto freedom = static_cast<double>(measured.residual.size());
    const double squared = measured.residual.dot(noise.solve(measured.residual));
    const double weight = robust ? 1 / (1 + squared / freedom) : 1;  // Cauchy
    for (const LinearMeasurement::Block& block : measured.blocks) {
      if (block.offset >= 0) continue;  // the map is taken as it is
      const std::size_t row = block.offset == own_offset ? at : other;
      equations_.add(row, Eigen::Vector3d(weight * block.by.transpose() * noise.solve(measured.residual)));
      for (const LinearMeasurement::Block& with : measured.blocks) {
        if (with.offset >= 0) continue;
        equations_.add(row, with.offset == own_offset ? at : other,
                       Eigen::Matrix3d(weight * block.by.transpose() * noise.solve(with.by)));
      }
    }
  }

  std::size_t own() const { return map_.robots.size() - 2; }

  std::span<const std::span<const Stop>> ways_;
  FeatureState map_;  ///< the robot that sees, and one that is seen, are its last two
  std::vector<std::size_t> first_;
  std::vector<Pose> poses_;  ///< way by way
  NormalEquations equations_{0};
};

}  // namespace

std::vector<std::vector<Pose>> smoothed_stops(std::span<const std::span<const Stop>> ways,
                                              const FeatureState& map) {
  return WaysFit(ways, map).run();
}

}  // namespace isthmus
