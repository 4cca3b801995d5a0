#include "server/feature_maps/meeting/placement.hpp"

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <numbers>
#include <set>

namespace isthmus {
namespace {

constexpr double pi = std::numbers::pi;

/// At most two independent measurements of the placing: what was measured less what the placing has it, with
/// σ of the measurement and of the estimates.
struct Rows {
  int count = 0;
  std::array<double, 2> residual{};
  std::array<double, 2> sigma{};
  std::array<double, 2> false_density{};  ///< of a clue that is false
};

bool is_measured(double sigma) { return std::isfinite(sigma); }

void add_row(Rows& rows, double residual, double variance, double density) {
  const auto at = static_cast<std::size_t>(rows.count++);
  rows.residual[at] = residual;
  rows.sigma[at] = std::sqrt(variance);
  rows.false_density[at] = density;
}

Rows place_rows(const Clue& clue, const Pose& one_from_two, double reach_m) {
  Rows rows;
  const Eigen::Vector2d off = clue.place - one_from_two * clue.target;
  Eigen::Matrix2d turn;
  turn << std::cos(one_from_two.yaw), -std::sin(one_from_two.yaw), std::sin(one_from_two.yaw),
      std::cos(one_from_two.yaw);
  const Eigen::Matrix2d both = clue.place_covariance + turn * clue.target_covariance * turn.transpose();
  for (const Eigen::Index axis : {0, 1}) add_row(rows, off(axis), both(axis, axis), 1 / (2 * reach_m));
  return rows;
}

Rows rows_of(const Clue& clue, const Pose& one_from_two, double reach_m) {
  if (clue.kind == ClueKind::same_place) return place_rows(clue, one_from_two, reach_m);
  const bool from_one = clue.kind == ClueKind::seen_from_one;
  const Pose observer_from_other = from_one ? one_from_two : inverse(one_from_two);
  const Eigen::Vector2d offset = observer_from_other * clue.target - position(clue.observer);
  const double range = std::max(offset.norm(), 1e-3);
  const Eigen::Vector2d ray = offset / range, side(-ray.y(), ray.x());
  const Eigen::Matrix2d& own = clue.observer_covariance.topLeftCorner<2, 2>();
  const Eigen::Vector2d ray_there = rotate(-observer_from_other.yaw, ray);
  const Eigen::Vector2d side_there = rotate(-observer_from_other.yaw, side);
  const auto along = [](const Eigen::Matrix2d& covariance, const Eigen::Vector2d& direction) {
    return direction.dot(covariance * direction);
  };
  Rows rows;
  if (is_measured(clue.range_sigma_m))
    add_row(rows, clue.range_m - range,
            std::pow(clue.range_sigma_m, 2) + along(own, ray) + along(clue.target_covariance, ray_there),
            1 / reach_m);
  if (is_measured(clue.bearing_sigma_rad))
    add_row(rows, wrap_angle(clue.bearing_rad - std::atan2(offset.y(), offset.x()) + clue.observer.yaw),
            std::pow(clue.bearing_sigma_rad, 2) + clue.observer_covariance(2, 2) +
                (along(own, side) + along(clue.target_covariance, side_there)) / (range * range),
            1 / (2 * pi));
  return rows;
}

double log_ratio(const Rows& rows, double widened = 1) {
  double sum = 0;
  for (std::size_t i = 0; i < static_cast<std::size_t>(rows.count); ++i) {
    const double sigma = widened * rows.sigma[i];
    const double z = rows.residual[i] / sigma;
    sum += -0.5 * z * z - std::log(sigma * std::sqrt(2 * pi) * rows.false_density[i]);
  }
  return sum;
}

/// log(share · exp(ratio) + 1 − share).
double mixed(double ratio, double share) {
  const double yes = std::log(share) + ratio, no = std::log1p(-share);
  return std::max(yes, no) + std::log1p(std::exp(-std::abs(yes - no)));
}

double log_sum(double a, double b) {
  const double high = std::max(a, b);
  return std::isfinite(high) ? high + std::log1p(std::exp(-std::abs(a - b))) : high;
}

/// A local answer, with logs of masses of the posterior.
struct Mode {
  MapPlacement placement;
  double mass = 0;       ///< near it
  double elsewhere = 0;  ///< of all that its own clues leave open
};

/// Clues with what the search needs of all of them.
class Search {
 public:
  Search(std::span<const Clue> clues, const PlacementOptions& options) : clues_(clues), options_(options) {
    for (const Clue& clue : clues) encounters_.insert(clue.encounter);
    prior_.diagonal() << 1 / std::pow(options.reach_m, 2), 1 / std::pow(options.reach_m, 2), 3 / (pi * pi);
  }

  std::vector<Pose> starts() const;
  Pose refined(Pose pose) const;
  std::optional<Mode> at(const Pose& pose) const;

 private:
  using Jacobian = Eigen::Matrix<double, 2, 3>;

  Jacobian jacobian(const Clue& clue, const Pose& pose) const {
    constexpr double step = 1e-5;
    Jacobian by = Jacobian::Zero();
    for (const Eigen::Index k : {0, 1, 2}) {
      Eigen::Vector3d more = to_vector(pose), less = more;
      more(k) += step;
      less(k) -= step;
      const Rows a = rows_of(clue, to_pose(more), options_.reach_m);
      const Rows b = rows_of(clue, to_pose(less), options_.reach_m);
      for (int i = 0; i < a.count; ++i) {
        const auto at = static_cast<std::size_t>(i);
        by(i, k) = wrap_angle(a.residual[at] - b.residual[at]) / (2 * step);
      }
    }
    return by;
  }

  Eigen::Matrix3d information(const Clue& clue, const Pose& pose) const {
    const Rows rows = rows_of(clue, pose, options_.reach_m);
    const Jacobian by = jacobian(clue, pose);
    Eigen::Matrix3d sum = Eigen::Matrix3d::Zero();
    for (int i = 0; i < rows.count; ++i)
      sum += by.row(i).transpose() * by.row(i) / std::pow(rows.sigma[static_cast<std::size_t>(i)], 2);
    return sum;
  }

  /// Of one encounter: the log of how much likelier its clues are here than if it were false.
  double encounter_log(int encounter, const Pose& pose) const {
    double sum = 0;
    for (const Clue& clue : clues_)
      if (clue.encounter == encounter)
        sum += mixed(log_ratio(rows_of(clue, pose, options_.reach_m)), options_.true_share);
    return mixed(sum, options_.true_share) - std::log1p(-options_.true_share);
  }

  /// The log of what mass of the prior lies within the posterior's width.
  double width_log(const Eigen::Matrix3d& information) const {
    const double volume = pi * std::pow(options_.reach_m, 2) * 2 * pi;
    const double determinant = (information + prior_).determinant();
    return std::min(0.0, 1.5 * std::log(2 * pi) - 0.5 * std::log(determinant) - std::log(volume));
  }

  /// The log of the share of a Gaussian that is another place.
  double log_astray(const Eigen::Matrix3d& covariance) const {
    double outside = 0;
    for (const Eigen::Index k : {0, 1, 2}) {
      const double bound = k == 2 ? options_.same_rad : options_.same_m;
      outside += std::erfc(bound / std::sqrt(2 * covariance(k, k)));
    }
    return std::log(std::min(1.0, outside) + 1e-300);
  }

  std::span<const Clue> clues_;
  const PlacementOptions& options_;
  std::set<int> encounters_;
  Eigen::Matrix3d prior_ = Eigen::Matrix3d::Zero();
};

/// As the first map would have it: from where, and where to.
struct Points {
  Eigen::Vector2d in_one;
  Eigen::Vector2d in_two;
};

std::optional<Points> points_of(const Clue& clue) {
  if (clue.kind == ClueKind::same_place) return Points{clue.place, clue.target};
  if (!is_measured(clue.range_sigma_m) || !is_measured(clue.bearing_sigma_rad)) return std::nullopt;
  const Eigen::Vector2d seen = clue.observer * Eigen::Vector2d(clue.range_m * std::cos(clue.bearing_rad),
                                                               clue.range_m * std::sin(clue.bearing_rad));
  return clue.kind == ClueKind::seen_from_one ? Points{seen, clue.target} : Points{clue.target, seen};
}

Pose carried(const Points& points, double yaw) {
  const Eigen::Vector2d offset = points.in_one - rotate(yaw, points.in_two);
  return {offset.x(), offset.y(), yaw};
}

/// Two points, each known in both maps.
std::optional<Pose> by_two_points(const Points& a, const Points& b, double min_apart_m) {
  const Eigen::Vector2d one = b.in_one - a.in_one, two = b.in_two - a.in_two;
  if (one.norm() < min_apart_m || two.norm() < min_apart_m) return std::nullopt;
  return carried(a, wrap_angle(std::atan2(one.y(), one.x()) - std::atan2(two.y(), two.x())));
}

/// Two robots that saw one another: their bearings are opposite (θ = π + ¹θ₂ − ²θ₁).
std::optional<Pose> by_bearings(const Clue& a, const Clue& b) {
  if (a.kind != ClueKind::seen_from_one || b.kind != ClueKind::seen_from_two) return std::nullopt;
  if (a.encounter != b.encounter || !points_of(a) || !points_of(b)) return std::nullopt;
  const double there = a.observer.yaw + a.bearing_rad, back = b.observer.yaw + b.bearing_rad;
  return carried(*points_of(a), wrap_angle(pi + there - back));
}

/// All about what a single clue leaves open.
std::vector<Pose> around(const Clue& clue, double reach_m) {
  constexpr int headings = 12, bearings = 12;
  std::vector<double> ranges{clue.range_m}, angles{clue.bearing_rad};
  if (!is_measured(clue.range_sigma_m)) ranges = {0.1 * reach_m, 0.3 * reach_m, 0.6 * reach_m};
  if (!is_measured(clue.bearing_sigma_rad)) {
    angles.clear();
    for (int k = 0; k < bearings; ++k) angles.push_back(2 * pi * k / bearings);
  }
  std::vector<Pose> poses;
  for (const double range : ranges) {
    for (const double angle : angles) {
      Clue whole = clue;
      whole.range_m = range;
      whole.bearing_rad = angle;
      whole.range_sigma_m = whole.bearing_sigma_rad = 0;
      for (int k = 0; k < headings; ++k)
        poses.push_back(carried(*points_of(whole), wrap_angle(2 * pi * k / headings)));
    }
  }
  return poses;
}

std::vector<Pose> Search::starts() const {
  std::vector<Pose> poses;
  const auto add = [&](const std::optional<Pose>& pose) {
    if (!pose || poses.size() >= options_.max_starts) return;
    const bool is_near = std::any_of(poses.begin(), poses.end(), [&](const Pose& other) {
      const Eigen::Vector3d off = wrapped_difference(*pose, other);
      return off.head<2>().norm() < options_.same_m && std::abs(off.z()) < options_.same_rad;
    });
    if (!is_near) poses.push_back(*pose);  // else it would be drawn to the same answer
  };
  bool any_in_part = false;
  // The newest first: they are what has not been tried.
  for (std::size_t i = clues_.size(); i-- > 0;) {
    const std::optional<Points> own = points_of(clues_[i]);
    any_in_part = any_in_part || !own;
    for (std::size_t k = i; own && k-- > 0;) {
      add(by_bearings(clues_[i], clues_[k]));
      add(by_bearings(clues_[k], clues_[i]));
      if (const std::optional<Points> other = points_of(clues_[k]))
        add(by_two_points(*own, *other, options_.min_apart_m));
    }
  }
  if (!any_in_part) return poses;
  const auto whole = std::find_if(clues_.begin(), clues_.end(), [](const Clue& c) { return !!points_of(c); });
  const Clue& base = whole != clues_.end() ? *whole : clues_.front();
  for (const Pose& pose : around(base, options_.reach_m)) add(pose);
  return poses;
}

/// Gauss and Newton, each clue weighted by how probable it is that it is true; from wide to as they say, so
/// that what is far off is drawn in.
Pose Search::refined(Pose pose) const {
  for (const double widened : {8.0, 8.0, 4.0, 4.0, 2.0, 2.0, 1.0, 1.0, 1.0}) {
    Eigen::Matrix3d sum = 1e-9 * Eigen::Matrix3d::Identity();
    Eigen::Vector3d pull = Eigen::Vector3d::Zero();
    for (const Clue& clue : clues_) {
      const Rows rows = rows_of(clue, pose, options_.reach_m);
      const double ratio = log_ratio(rows, widened);
      const double weight =
          std::exp(std::log(options_.true_share) + ratio - mixed(ratio, options_.true_share));
      const Jacobian by = jacobian(clue, pose);
      for (int i = 0; i < rows.count; ++i) {
        const auto at = static_cast<std::size_t>(i);
        const double certainty = weight / std::pow(rows.sigma[at], 2);
        sum += certainty * by.row(i).transpose() * by.row(i);
        pull -= certainty * rows.residual[at] * by.row(i).transpose();
      }
    }
    const Eigen::Vector3d step = sum.ldlt().solve(pull);
    if (!step.allFinite()) break;
    pose = to_pose(to_vector(pose) + step.cwiseMax(-options_.reach_m).cwiseMin(options_.reach_m));
    pose.yaw = wrap_angle(pose.yaw);
  }
  return pose;
}

std::optional<Mode> Search::at(const Pose& pose) const {
  Mode mode;
  MapPlacement& placement = mode.placement;
  placement.one_from_two = pose;
  Eigen::Matrix3d total = Eigen::Matrix3d::Zero();
  std::map<int, Eigen::Matrix3d> of_encounter;
  for (std::size_t i = 0; i < clues_.size(); ++i) {
    if (clue_log_ratio(clues_[i], pose, options_) <= 0) continue;
    placement.agreeing.push_back(i);
    const Eigen::Matrix3d own = information(clues_[i], pose);
    total += own;
    of_encounter.try_emplace(clues_[i].encounter, Eigen::Matrix3d::Zero()).first->second += own;
  }
  // Determined by what was seen, not by where a placing may be at all.
  const Eigen::LLT<Eigen::Matrix3d> factor(total);
  if (factor.info() != Eigen::Success || total.determinant() < 1e3 * prior_.determinant())
    return std::nullopt;
  placement.covariance = (total + prior_).inverse();
  double all = 0;
  for (const int encounter : encounters_) all += encounter_log(encounter, pose);
  mode.mass = all + width_log(total);
  mode.elsewhere = 0;  // that none is true: all would be as likely as they are
  for (const auto& [encounter, own] : of_encounter) {
    const double astray = log_astray((total - own + prior_).inverse());
    mode.elsewhere =
        log_sum(mode.elsewhere, all - encounter_log(encounter, pose) + width_log(total - own) + astray);
  }
  return mode;
}

bool is_same(const MapPlacement& a, const MapPlacement& b, const PlacementOptions& options) {
  const Eigen::Vector3d off = wrapped_difference(a.one_from_two, b.one_from_two);
  if (off.head<2>().norm() < options.same_m && std::abs(off.z()) < options.same_rad) return true;
  return off.dot((a.covariance + b.covariance).llt().solve(off)) < std::pow(options.same_sigmas, 2);
}

}  // namespace

double clue_log_ratio(const Clue& clue, const Pose& one_from_two, const PlacementOptions& options) {
  return log_ratio(rows_of(clue, one_from_two, options.reach_m));
}

std::optional<MapPlacement> best_placement(std::span<const Clue> clues, const PlacementOptions& options) {
  if (clues.empty()) return std::nullopt;
  const Search search(clues, options);
  std::vector<Mode> modes;
  for (const Pose& start : search.starts()) {
    const std::optional<Mode> found = search.at(search.refined(start));
    if (!found) continue;
    const auto known = std::find_if(modes.begin(), modes.end(), [&](const Mode& mode) {
      return is_same(mode.placement, found->placement, options);
    });
    if (known == modes.end()) {
      modes.push_back(*found);
    } else if (found->mass > known->mass) {
      *known = *found;
    }
  }
  if (modes.empty()) return std::nullopt;
  const auto best = std::max_element(modes.begin(), modes.end(),
                                     [](const Mode& a, const Mode& b) { return a.mass < b.mass; });
  double elsewhere = best->elsewhere;
  for (auto mode = modes.begin(); mode != modes.end(); ++mode)
    if (mode != best) elsewhere = log_sum(elsewhere, mode->mass);
  MapPlacement result = best->placement;
  result.log_odds = best->mass - elsewhere;
  return result;
}

}  // namespace isthmus
