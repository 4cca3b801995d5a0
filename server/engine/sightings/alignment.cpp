#include "server/engine/sightings/alignment.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>

namespace isthmus {
namespace {

constexpr int max_iterations = 10;  // of Gauss-Newton from a pose that a few sightings fit: three or four do

// A residual of range and bearing, whitened, by (x, y, yaw) of first_from_second.
struct Residual {
  int rows = 0;
  Eigen::Vector2d e = Eigen::Vector2d::Zero();
  Eigen::Matrix<double, 2, 3> by_pose = Eigen::Matrix<double, 2, 3>::Zero();
};

// How what an observer sees moves with the pose of the second plane in the first.
Eigen::Matrix<double, 2, 3> by_planes(const ProjectedSighting& s, const Pose& first_from_second,
                                      double observer_from_plane_rad) {
  Eigen::Matrix<double, 2, 3> by_pose;
  if (s.observer_in_first) {
    by_pose = point_jacobian(first_from_second, s.target);
  } else {
    const Eigen::Vector2d from_origin = s.target - position(first_from_second);
    const Eigen::Vector2d back = rotate(-first_from_second.yaw, from_origin);
    const Eigen::Matrix2d turn = Eigen::Rotation2Dd(-first_from_second.yaw).toRotationMatrix();
    by_pose.leftCols<2>() = -turn;
    by_pose.col(2) = Eigen::Vector2d(back.y(), -back.x());
  }
  return Eigen::Rotation2Dd(observer_from_plane_rad).toRotationMatrix() * by_pose;
}

Residual residual_of(const ProjectedSighting& s, const Pose& first_from_second,
                     const AlignmentOptions& options) {
  const Pose plane_from_target_plane = s.observer_in_first ? first_from_second : inverse(first_from_second);
  const Pose observer_from_plane = inverse(s.plane_from_observer);
  const Eigen::Vector2d seen = observer_from_plane * (plane_from_target_plane * s.target);
  const double range = std::max(seen.norm(), 1e-3);
  const Eigen::Vector2d radial = seen / range;
  const Eigen::Vector2d across(-radial.y(), radial.x());

  const Eigen::Matrix<double, 2, 3> by_pose = by_planes(s, first_from_second, observer_from_plane.yaw);
  // And how it moves with the observer's own pose, in its own axes.
  Eigen::Matrix<double, 2, 3> by_observer;
  by_observer << -1, 0, seen.y(), 0, -1, -seen.x();
  Eigen::Matrix2d covariance = by_observer * s.observer_covariance * by_observer.transpose();
  covariance.diagonal().array() += s.target_variance + options.floor_m * options.floor_m;

  Residual residual;
  const auto add = [&](const Eigen::Vector2d& direction, double off, double variance, double scale) {
    const double sigma = std::sqrt(variance);
    residual.e(residual.rows) = off / sigma;
    residual.by_pose.row(residual.rows++) = scale * direction.transpose() * by_pose / sigma;
  };
  if (s.has_range())
    add(radial, range - s.range_m, s.range_sigma_m * s.range_sigma_m + radial.dot(covariance * radial), 1);
  if (s.has_bearing())
    add(across, wrap_angle(std::atan2(seen.y(), seen.x()) - s.bearing_rad),
        s.bearing_sigma_rad * s.bearing_sigma_rad + options.floor_rad * options.floor_rad +
            across.dot(covariance * across) / (range * range),
        1 / range);
  return residual;
}

// The points of both planes that a sighting says are one.
struct Tie {
  std::size_t sighting;
  Eigen::Vector2d first;
  Eigen::Vector2d second;
};

std::vector<Tie> ties_of(std::span<const ProjectedSighting> sightings) {
  std::vector<Tie> ties;
  for (std::size_t i = 0; i < sightings.size(); ++i) {
    const ProjectedSighting& s = sightings[i];
    if (!s.has_range() || !s.has_bearing()) continue;
    const Eigen::Vector2d measured =
        s.plane_from_observer *
        Eigen::Vector2d(s.range_m * std::cos(s.bearing_rad), s.range_m * std::sin(s.bearing_rad));
    ties.push_back(s.observer_in_first ? Tie{i, measured, s.target} : Tie{i, s.target, measured});
  }
  return ties;
}

// Two points of the second plane laid on two of the first; nothing where they are too near for that.
std::optional<Pose> lay(const Tie& a, const Tie& b, const AlignmentOptions& options) {
  const Eigen::Vector2d first = b.first - a.first;
  const Eigen::Vector2d second = b.second - a.second;
  const double length = first.norm();
  if (length < options.min_baseline_m || second.norm() < options.min_baseline_m) return std::nullopt;
  const double yaw = wrap_angle(std::atan2(first.y(), first.x()) - std::atan2(second.y(), second.x()));
  const Eigen::Vector2d middle = 0.5 * (a.first + b.first) - rotate(yaw, 0.5 * (a.second + b.second));
  return Pose{middle.x(), middle.y(), yaw};
}

std::vector<std::size_t> supporters_of(std::span<const ProjectedSighting> sightings, const Pose& pose,
                                       const AlignmentOptions& options) {
  std::vector<std::size_t> supporters;
  for (std::size_t i = 0; i < sightings.size(); ++i)
    if (agrees(sightings[i], pose, options)) supporters.push_back(i);
  return supporters;
}

double cost(std::span<const ProjectedSighting> sightings, std::span<const std::size_t> supporters,
            const Pose& pose, const AlignmentOptions& options) {
  double sum = 0;
  for (const std::size_t i : supporters) sum += chi_squared(sightings[i], pose, options);
  return sum;
}

double widest(std::span<const Tie> ties, std::span<const std::size_t> supporters) {
  double most = 0;
  for (const Tie& a : ties)
    for (const Tie& b : ties) {
      const bool both = std::ranges::find(supporters, a.sighting) != supporters.end() &&
                        std::ranges::find(supporters, b.sighting) != supporters.end();
      if (both) most = std::max(most, (a.first - b.first).norm());
    }
  return most;
}

}  // namespace

bool ProjectedSighting::has_range() const { return std::isfinite(range_sigma_m); }
bool ProjectedSighting::has_bearing() const { return std::isfinite(bearing_sigma_rad); }

double chi_squared(const ProjectedSighting& sighting, const Pose& first_from_second,
                   const AlignmentOptions& options) {
  return residual_of(sighting, first_from_second, options).e.squaredNorm();
}

bool agrees(const ProjectedSighting& sighting, const Pose& first_from_second,
            const AlignmentOptions& options) {
  const int measured = (sighting.has_range() ? 1 : 0) + (sighting.has_bearing() ? 1 : 0);
  return measured == 0 ||
         chi_squared(sighting, first_from_second, options) <= options.common.surprise.bound(measured);
}

Alignment fit_alignment(std::span<const ProjectedSighting> sightings, std::vector<std::size_t> supporters,
                        const Pose& start, const AlignmentOptions& options) {
  Alignment alignment;
  Pose pose = start;
  Eigen::Matrix3d information = Eigen::Matrix3d::Zero();
  for (int iteration = 0; iteration < max_iterations; ++iteration) {
    information.setZero();
    Eigen::Vector3d gradient = Eigen::Vector3d::Zero();
    for (const std::size_t i : supporters) {
      const Residual r = residual_of(sightings[i], pose, options);
      information += r.by_pose.transpose() * r.by_pose;
      gradient += r.by_pose.transpose() * r.e;
    }
    const Eigen::Matrix3d damped = information + 1e-6 * Eigen::Matrix3d::Identity();
    const Eigen::Vector3d step = -damped.ldlt().solve(gradient);
    pose = to_pose(to_vector(pose) + step);
    if (step.norm() < 1e-9) break;
  }
  alignment.first_from_second = pose;
  alignment.covariance = (information + 1e-6 * Eigen::Matrix3d::Identity()).inverse();
  const auto in_first = static_cast<std::size_t>(
      std::ranges::count_if(supporters, [&](std::size_t i) { return sightings[i].observer_in_first; }));
  alignment.two_way = in_first > 0 && in_first < supporters.size();
  alignment.baseline_m = widest(ties_of(sightings), supporters);
  alignment.supporters = std::move(supporters);
  return alignment;
}

std::optional<Alignment> best_alignment(std::span<const ProjectedSighting> sightings,
                                        const AlignmentOptions& options) {
  const std::vector<Tie> ties = ties_of(sightings);
  std::vector<std::size_t> best;
  Pose best_pose;
  double best_cost = 0;
  for (std::size_t i = 0; i < ties.size(); ++i) {
    for (std::size_t j = i + 1; j < ties.size(); ++j) {
      const std::optional<Pose> pose = lay(ties[i], ties[j], options);
      if (!pose) continue;
      std::vector<std::size_t> supporters = supporters_of(sightings, *pose, options);
      if (supporters.size() < 2 || supporters.size() < best.size()) continue;
      const double its_cost = cost(sightings, supporters, *pose, options);
      if (supporters.size() == best.size() && its_cost >= best_cost) continue;
      best = std::move(supporters);
      best_pose = *pose;
      best_cost = its_cost;
    }
  }
  if (best.size() < 2) return std::nullopt;
  Alignment alignment = fit_alignment(sightings, best, best_pose, options);
  // What agrees with the refined pose; twice is enough to settle.
  for (int round = 0; round < 2; ++round) {
    std::vector<std::size_t> supporters = supporters_of(sightings, alignment.first_from_second, options);
    if (supporters == alignment.supporters || supporters.size() < alignment.supporters.size()) break;
    alignment = fit_alignment(sightings, std::move(supporters), alignment.first_from_second, options);
  }
  // Its supporters are those that agree with it as it is now.
  std::vector<std::size_t> still = supporters_of(sightings, alignment.first_from_second, options);
  if (still.size() < alignment.supporters.size())
    alignment = fit_alignment(sightings, std::move(still), alignment.first_from_second, options);
  if (alignment.supporters.size() < 2) return std::nullopt;
  return alignment;
}

bool ready(const Alignment& alignment, std::span<const ProjectedSighting> sightings, std::int64_t now_utime,
           bool no_more_waiting, const AlignmentOptions& options) {
  std::int64_t from = sightings[alignment.supporters.front()].utime;
  std::int64_t to = from;
  for (const std::size_t i : alignment.supporters) {
    from = std::min(from, sightings[i].utime);
    to = std::max(to, sightings[i].utime);
  }
  int rivals = 0;
  for (std::size_t i = 0; i < sightings.size(); ++i) {
    const bool supports = std::ranges::find(alignment.supporters, i) != alignment.supporters.end();
    const bool near =
        sightings[i].utime >= from - options.rival_us && sightings[i].utime <= to + options.rival_us;
    if (!supports && near) ++rivals;
  }
  const auto supporters = static_cast<int>(alignment.supporters.size());
  if (supporters <= rivals) return false;
  if (!alignment.two_way)
    return supporters >= options.common.agreeing && alignment.baseline_m >= options.common.baseline_m;
  return supporters >= options.common.agreeing || no_more_waiting || now_utime > to + options.lone_pair_us;
}

}  // namespace isthmus
