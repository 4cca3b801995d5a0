#include "scanmatch/match.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

namespace isthmus {
namespace {

// A beam's end with the sums that one beam contributes, over the patches it is paired with.
struct Beam {
  int point = 0;
  Eigen::Vector2d position;  // in the robot's frame
  Eigen::Vector2d normal;    // in the robot's frame; zero: none
  double noise_m2 = 0;       // of the laser, across the surface

  // A beam errs by its laser's noise besides what the loss is for: the squares add.
  double squared_scale(double kernel) const { return kernel * kernel + noise_m2; }
};

struct NormalEquations {
  Eigen::Matrix3d h = Eigen::Matrix3d::Zero();
  Eigen::Vector3d g = Eigen::Vector3d::Zero();
  double weight_sum = 0;   // of the beams' best weights
  double squared_sum = 0;  // weighted squared distances
  double squared_weight = 0;
  int paired = 0;
};

std::vector<Beam> choose_beams(std::span<const ScanPoint> points, int most) {
  std::vector<Beam> beams;
  beams.reserve(std::min<std::size_t>(points.size(), static_cast<std::size_t>(most) * 2));
  const int stride = std::max(1, static_cast<int>(points.size() + static_cast<std::size_t>(most) / 2) / most);
  for (int i = stride / 2; i < static_cast<int>(points.size()); i += stride) {
    const ScanPoint& point = points[static_cast<std::size_t>(i)];
    beams.push_back({i, point.position, point.normal, point.noise_m2});
  }
  return beams;
}

// Geman-McClure's weight of a squared distance: like Cauchy's near zero, falling faster far out.
double robust_weight(double squared, double squared_scale) {
  const double ratio = 1 + squared / squared_scale;
  return 1 / (ratio * ratio);
}

// What a line through a point says so far aside of it, as a share of what it says there: its direction is
// known from how far its points are spread, and adds aside² / spread to the variance of one point (Draper and
// Smith, 1998, "Applied regression analysis", section 3.1).
double sureness(const ScanPoint& line, const Eigen::Vector2d& at) {
  const Eigen::Vector2d off = at - line.position;
  const double aside = line.normal.x() * off.y() - line.normal.y() * off.x();
  constexpr double least_m2 = 1e-6;
  const double spread_m2 = std::max<double>(line.spread_m2, least_m2);
  return spread_m2 / (spread_m2 + aside * aside);
}

// A beam on a line of a patch, in the local frame: what is left of it while it stays paired.
struct Hit {
  Eigen::Vector2d normal;    // of the line
  double offset = 0;         // of the line along its normal
  Eigen::Vector2d position;  // of the beam's end, in the robot's frame
  double sureness = 1;       // of the line where the beam ends
  double residual = 0;
  double weight = 0;
  int beam = 0;
  int patch = 0;
  int line = 0;
};

class Matcher {
 public:
  Matcher(const LocalMap& map, std::span<const ScanPoint> points, const MatchOptions& options)
      : map_(map), options_(options), beams_(choose_beams(points, options.max_points)) {
    for (const LocalPatch& local : map.patches) {
      patch_from_local_.push_back(inverse(local.local_from_patch));
    }
    hits_.reserve(beams_.size() * map.patches.size());
  }

  // Sums the normal equations by (x, y, yaw) of the pose in the local frame. Beams keep the lines that they
  // were paired with until the pose has moved by what may pair them otherwise.
  NormalEquations linearise(const Pose& pose, double kernel) {
    const bool moved = std::hypot(pose.x - paired_at_.x, pose.y - paired_at_.y) > options_.pair_again_m ||
                       std::abs(wrap_angle(pose.yaw - paired_at_.yaw)) > options_.pair_again_rad;
    return !paired_ || moved ? linearise_anew(pose, kernel) : sum(pose, kernel);
  }

  // The same, all beams paired at this pose.
  NormalEquations linearise_anew(const Pose& pose, double kernel) {
    pair(pose, kernel);
    return sum(pose, kernel);
  }

  // Those that the last sum was made of.
  std::vector<Pair> pairs() const {
    std::vector<Pair> pairs;
    for (const Hit& hit : hits_) {
      if (hit.weight > 0)
        pairs.push_back({hit.patch, beams_[static_cast<std::size_t>(hit.beam)].point, hit.line, hit.weight});
    }
    return pairs;
  }

  int beams() const { return static_cast<int>(beams_.size()); }

 private:
  double gate(double squared_scale) const {
    return std::max(options_.min_gate_m, options_.gate_kernels * std::sqrt(squared_scale));
  }

  // A patch, and the turns and steps into it and back.
  struct Frame {
    const Patch* patch;
    double c, s, x, y;      // patch_from_robot
    double lc, ls, lx, ly;  // local_from_patch
  };

  std::vector<Frame> frames_at(const Pose& pose) const {
    std::vector<Frame> frames(map_.patches.size());
    for (std::size_t k = 0; k < frames.size(); ++k) {
      const Pose there = patch_from_local_[k] * pose;
      const Pose& back = map_.patches[k].local_from_patch;
      frames[k] = {map_.patches[k].patch.get(),
                   std::cos(there.yaw),
                   std::sin(there.yaw),
                   there.x,
                   there.y,
                   std::cos(back.yaw),
                   std::sin(back.yaw),
                   back.x,
                   back.y};
    }
    return frames;
  }

  void pair(const Pose& pose, double kernel) {
    paired_ = true;
    paired_at_ = pose;
    hits_.clear();
    const double min_cosine = std::cos(options_.max_normal_angle_rad);
    const std::vector<Frame> frames = frames_at(pose);
    for (std::size_t i = 0; i < beams_.size(); ++i) {
      const Beam& beam = beams_[i];
      const double max_off = gate(beam.squared_scale(kernel));
      const Eigen::Vector2d& p = beam.position;
      const bool has_normal = beam.normal.squaredNorm() > 0.5;
      for (std::size_t k = 0; k < frames.size(); ++k) {
        const Frame& f = frames[k];
        const Eigen::Vector2d at(f.c * p.x() - f.s * p.y() + f.x, f.s * p.x() + f.c * p.y() + f.y);
        const int line = f.patch->index.nearest(at);
        if (line < 0) continue;
        const ScanPoint& target = f.patch->points[static_cast<std::size_t>(line)];
        if (std::abs(target.distance_from_line_m(at)) > max_off) continue;
        const Eigen::Vector2d normal(f.c * beam.normal.x() - f.s * beam.normal.y(),
                                     f.s * beam.normal.x() + f.c * beam.normal.y());
        if (has_normal && normal.dot(target.normal) < min_cosine) continue;
        const Eigen::Vector2d local_normal(f.lc * target.normal.x() - f.ls * target.normal.y(),
                                           f.ls * target.normal.x() + f.lc * target.normal.y());
        hits_.push_back({local_normal,
                         -target.distance_from_line_m(Eigen::Vector2d::Zero()) + local_normal.x() * f.lx +
                             local_normal.y() * f.ly,
                         p, sureness(target, at), 0, 0, static_cast<int>(i), static_cast<int>(k), line});
      }
    }
  }

  NormalEquations sum(const Pose& pose, double kernel) {
    NormalEquations sums;
    const double c = std::cos(pose.yaw);
    const double s = std::sin(pose.yaw);
    const double sharp = options_.kernel_m * options_.kernel_m;
    for (std::size_t first = 0, end = 0; first < hits_.size(); first = end) {
      const Beam& beam = beams_[static_cast<std::size_t>(hits_[first].beam)];
      const double squared_scale = beam.squared_scale(kernel);
      const double max_off = gate(squared_scale);
      const Eigen::Vector2d& p = beam.position;
      const Eigen::Vector2d arm(c * p.x() - s * p.y(), s * p.x() + c * p.y());
      const double x = arm.x() + pose.x;
      const double y = arm.y() + pose.y;
      int count = 0;
      double best = 0;
      for (end = first; end < hits_.size() && hits_[end].beam == hits_[first].beam; ++end) {
        Hit& hit = hits_[end];
        hit.residual = hit.normal.x() * x + hit.normal.y() * y - hit.offset;
        hit.weight = 0;
        if (std::abs(hit.residual) > max_off) continue;
        hit.weight = robust_weight(hit.residual * hit.residual, squared_scale);
        best = std::max(best, hit.weight);
        ++count;
      }
      if (count == 0) continue;
      ++sums.paired;
      sums.weight_sum += best;
      const double share = sharp / (beam.squared_scale(options_.kernel_m) * count);
      for (std::size_t i = first; i < end; ++i) add(hits_[i], arm, share, sums);
    }
    return sums;
  }

  static void add(Hit& hit, const Eigen::Vector2d& arm, double share, NormalEquations& sums) {
    hit.weight *= share * hit.sureness;
    const Eigen::Vector3d jacobian(hit.normal.x(), hit.normal.y(),
                                   hit.normal.y() * arm.x() - hit.normal.x() * arm.y());
    const Eigen::Vector3d weighted = hit.weight * jacobian;
    sums.h.noalias() += weighted * jacobian.transpose();
    sums.g.noalias() += hit.residual * weighted;
    sums.squared_sum += hit.weight * hit.residual * hit.residual;
    sums.squared_weight += hit.weight;
  }

  const LocalMap& map_;
  const MatchOptions& options_;
  std::vector<Beam> beams_;
  std::vector<Pose> patch_from_local_;
  bool paired_ = false;
  Pose paired_at_;
  std::vector<Hit> hits_;  // by beam, then by patch
};

// How the beams' information is spread over the plane's directions, the yaw left free.
struct Directions {
  Eigen::Matrix2d axes = Eigen::Matrix2d::Identity();
  Eigen::Vector2d share = Eigen::Vector2d::Zero();  // of each axis, per unit of weight, ascending
};

Directions directions_of(const NormalEquations& sums) {
  const double yaw_information = std::max(sums.h(2, 2), 1e-12);
  const Eigen::Matrix2d plane = sums.h.topLeftCorner<2, 2>() - sums.h.topRightCorner<2, 1>() *
                                                                   sums.h.bottomLeftCorner<1, 2>() /
                                                                   yaw_information;
  Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d> solver;
  solver.computeDirect(plane);
  return {solver.eigenvectors(), (solver.eigenvalues() / std::max(sums.squared_weight, 1e-12)).cwiseMax(0.0)};
}

Eigen::Matrix2d direction_trust(const Directions& directions, double thin) {
  Eigen::Vector2d trust;
  for (int i = 0; i < 2; ++i) {
    const double squared = directions.share(i) * directions.share(i);
    const double of_information = std::sqrt(squared / (squared + thin * thin + 1e-12));
    trust(i) = std::sqrt(of_information);
  }
  return directions.axes * trust.asDiagonal() * directions.axes.transpose();
}

Eigen::Matrix3d damped(const Eigen::Matrix3d& h, double damping) {
  return h + damping * Eigen::Matrix3d::Identity();
}

// Of the beams alone.
Eigen::Vector3d newton_step(const NormalEquations& sums, double damping) {
  return -damped(sums.h, damping).ldlt().solve(sums.g);
}

MatchQuality quality_of(const NormalEquations& sums, const Directions& directions, int beams, double thin) {
  MatchQuality quality;
  quality.beams = beams;
  quality.paired_beams = sums.paired;
  if (beams == 0 || sums.paired == 0) return quality;
  quality.score = sums.weight_sum / beams;
  quality.rms_m = std::sqrt(sums.squared_sum / std::max(sums.squared_weight, 1e-12));
  quality.degenerate = directions.share(0) < thin;
  return quality;
}

}  // namespace

Match match_scan(const LocalMap& local_map, std::span<const ScanPoint> points, const Prediction& prediction,
                 const MatchOptions& options) {
  Match match;
  match.local_from_robot = prediction.local_from_robot;
  Matcher matcher(local_map, points, options);
  Pose pose = prediction.start.value_or(prediction.local_from_robot);
  double kernel = std::max(options.start_kernel_m, options.kernel_m);
  const double information_of_unit = 1 / (options.sigma_m * options.sigma_m);
  for (int iteration = 0; iteration < options.max_iterations; ++iteration) {
    const NormalEquations sums = matcher.linearise(pose, kernel);
    if (sums.paired < options.min_pairs) return match;
    Eigen::Matrix3d trust = Eigen::Matrix3d::Identity();
    trust.topLeftCorner<2, 2>() = direction_trust(directions_of(sums), options.thin_direction);
    const Eigen::Vector3d innovation = wrapped_difference(pose, prediction.local_from_robot);
    const Eigen::Matrix3d of_beams = information_of_unit * (trust * sums.h * trust);
    // While the loss is wide, beams may lead far from where the fit begins. At the end they pull to where
    // they alone would have the pose, by no more than the information that they are trusted with.
    Eigen::Vector3d pull = -information_of_unit * (trust * sums.g);
    if (kernel <= options.kernel_m) pull = of_beams * newton_step(sums, options.damping);
    const Eigen::Matrix3d h = damped(of_beams + prediction.information, options.damping);
    Eigen::Vector3d step = h.ldlt().solve(pull - prediction.information * innovation);
    if (!step.allFinite()) return match;
    const double length = step.head<2>().norm();
    if (length > options.max_step_m) step *= options.max_step_m / length;
    pose = to_pose(to_vector(pose) + step);
    const bool settled = length < options.settled_m && std::abs(step.z()) < options.settled_rad;
    if (settled && kernel <= options.kernel_m) break;
    kernel = std::max(options.kernel_m, settled ? options.kernel_m : options.kernel_shrink * kernel);
  }
  const NormalEquations sums = matcher.linearise_anew(pose, options.kernel_m);
  match.pairs = matcher.pairs();
  match.local_from_robot = pose;
  const Directions directions = directions_of(sums);
  match.direction_trust = direction_trust(directions, options.thin_direction);
  Eigen::Matrix3d trust = Eigen::Matrix3d::Identity();
  trust.topLeftCorner<2, 2>() = match.direction_trust;
  match.beam_information = information_of_unit * (trust * sums.h * trust);
  match.quality = quality_of(sums, directions, matcher.beams(), options.thin_direction);
  match.ok = sums.paired >= options.min_pairs;
  return match;
}

}  // namespace isthmus
