#include "tools/evaluate/landmark_log.hpp"

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <cmath>
#include <map>
#include <numbers>
#include <optional>
#include <random>

#include "tools/text/words.hpp"

namespace isthmus {
namespace {

class LandmarkReader {
 public:
  explicit LandmarkReader(const std::string& file) : words_(file) {}

  LandmarkLog read() {
    while (words_.next()) {
      if (words_.word(0) == "ODOMETRY" || words_.word(0) == "EDGE2") {
        take_odometry();
      } else if (words_.word(0) == "LANDMARK") {
        take_landmark();
      } else {
        words_.fail("unknown line '" + std::string(words_.word(0)) + "'");
      }
    }
    if (log_.steps.empty()) words_.fail("no ODOMETRY, EDGE2 or LANDMARK line");
    return std::move(log_);
  }

 private:
  void take_odometry() {
    words_.expect_words(12);
    require_last_pose();
    const long to = words_.integer(2);
    if (to == last_pose_) words_.fail("a step from a pose to itself");
    last_pose_ = to;
    log_.steps.push_back(
        {{words_.number(3), words_.number(4), wrap_angle(words_.number(5))}, covariance_at<3>(6), {}});
  }

  void take_landmark() {
    words_.expect_words(8);
    require_last_pose();
    const long id = words_.integer(2);
    const auto [place, is_new] = landmarks_.try_emplace(id, static_cast<int>(landmarks_.size()));
    if (is_new) log_.landmark_ids.push_back(id);
    log_.steps.back().sightings.push_back(
        {place->second, {words_.number(3), words_.number(4)}, covariance_at<2>(5)});
  }

  /// The first line's pose begins the log; from then on lines are of the pose reached last.
  void require_last_pose() {
    const long from = words_.integer(1);
    if (!last_pose_) {
      last_pose_ = from;
      log_.steps.emplace_back();
    }
    if (from != last_pose_)
      words_.fail("from pose " + std::to_string(from) + ", but the pose reached last is " +
                  std::to_string(*last_pose_));
  }

  template <int size>
  Eigen::Matrix<double, size, size> covariance_at(std::size_t word) const {
    Eigen::Matrix<double, size, size> root = Eigen::Matrix<double, size, size>::Zero();
    for (int row = 0; row < size; ++row)
      for (int column = row; column < size; ++column) root(row, column) = words_.number(word++);
    if (!(root.diagonal().cwiseAbs().minCoeff() > 1e-9))
      words_.fail("a square root of information with a zero on its diagonal");
    return (root.transpose() * root).inverse();
  }

  WordReader words_;
  LandmarkLog log_;
  std::map<long, int> landmarks_;
  std::optional<long> last_pose_;
};

/// Deviates of Box and Muller, for the standard library's differ.
class Normal {
 public:
  explicit Normal(std::uint64_t seed) : engine_(seed) {}

  template <int size>
  Eigen::Matrix<double, size, 1> draw(const Eigen::Matrix<double, size, size>& covariance) {
    Eigen::Matrix<double, size, 1> unit;
    for (int k = 0; k < size; ++k) {
      const double radius = std::sqrt(-2 * std::log(1 - uniform()));
      unit(k) = radius * std::cos(2 * std::numbers::pi * uniform());
    }
    return covariance.llt().matrixL() * unit;
  }

 private:
  double uniform() { return static_cast<double>(engine_() >> 11U) * 0x1p-53; }

  std::mt19937_64 engine_;
};

}  // namespace

LandmarkLog read_landmark_log(const std::string& file) { return LandmarkReader(file).read(); }

LandmarkTruth true_map(const LandmarkLog& exact) {
  LandmarkTruth truth;
  Pose pose;
  for (const LandmarkStep& step : exact.steps) {
    pose = pose * step.old_from_new;
    truth.poses.push_back(pose);
    for (const LandmarkSighting& seen : step.sightings)
      if (static_cast<std::size_t>(seen.landmark) == truth.landmarks.size())
        truth.landmarks.push_back(pose * seen.place);
  }
  return truth;
}

LandmarkLog with_noise(const LandmarkLog& exact, std::uint64_t seed) {
  LandmarkLog log = exact;
  Normal normal(seed);
  for (std::size_t i = 0; i < log.steps.size(); ++i) {
    LandmarkStep& step = log.steps[i];
    if (i > 0) step.old_from_new = to_pose(to_vector(step.old_from_new) + normal.draw<3>(step.covariance));
    for (LandmarkSighting& seen : step.sightings) seen.place += normal.draw<2>(seen.covariance);
  }
  return log;
}

}  // namespace isthmus
