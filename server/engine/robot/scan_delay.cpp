#include "server/engine/robot/scan_delay.hpp"

#include <algorithm>
#include <cmath>

namespace isthmus {
namespace {

std::vector<double> delays_s(const ScanDelayOptions& options) {
  const int to_each_side = static_cast<int>(std::lround(options.max_s / options.step_s));
  std::vector<double> delays;
  for (int k = -to_each_side; k <= to_each_side; ++k) delays.push_back(k * options.step_s);
  return delays;
}

std::int64_t us_of(double seconds) { return std::llround(1e6 * seconds); }

// The mean of a delay of any length, or none where that is the more probable: one robot in two has none.
double most_probable_s(const std::vector<double>& delays, const std::vector<double>& log_likelihoods,
                       const ScanDelayOptions& options) {
  std::vector<double> log_priors;
  double priors = 0;
  for (const double delay : delays) {
    log_priors.push_back(-0.5 * std::pow(delay / options.sigma_s, 2));
    priors += std::exp(log_priors.back());
  }
  const double most = *std::ranges::max_element(log_likelihoods);
  double sum = 0, weights = 0;
  for (std::size_t k = 0; k < delays.size(); ++k) {
    const double weight = std::exp(log_priors[k] + log_likelihoods[k] - most) / priors;
    sum += weight * delays[k];
    weights += weight;
  }
  const double none = std::exp(log_likelihoods[delays.size() / 2] - most);
  return weights > none ? sum / weights : 0;
}

}  // namespace

void ScanDelay::learn(const MatchedTurn& turn, const OdometryTrack& odometry, const ScanDelayOptions& options,
                      const OdometryBiasOptions& as_bias) {
  if (odometry.empty()) return;
  const std::int64_t max_us = us_of(options.max_s);
  waiting_.push_back(turn);
  while (waiting_.front().to_utime + max_us <= odometry.newest_own_utime()) {
    weigh(waiting_.front(), odometry, options, as_bias);
    waiting_.pop_front();
    if (waiting_.empty()) return;
  }
  // Odometry that comes no more would let them grow without end.
  while (waiting_.front().to_utime + 2 * max_us < turn.to_utime) waiting_.pop_front();
}

void ScanDelay::weigh(const MatchedTurn& turn, const OdometryTrack& odometry, const ScanDelayOptions& options,
                      const OdometryBiasOptions& as_bias) {
  const std::vector<double> delays = delays_s(options);
  const double scale = turn.variance_rad2 + as_bias.match_sigma_rad * as_bias.match_sigma_rad;
  const std::int64_t first_us = us_of(delays.front()), step_us = us_of(options.step_s);
  const std::vector<double> from =
      odometry.own_yaws_back_from(turn.from_utime - first_us, step_us, delays.size());
  const std::vector<double> to =
      odometry.own_yaws_back_from(turn.to_utime - first_us, step_us, delays.size());
  if (from.empty() || to.empty()) return;
  log_likelihoods_.resize(delays.size(), 0);
  const double kept = std::exp(-std::abs(turn.rad) / as_bias.memory_rad);
  for (std::size_t k = 0; k < delays.size(); ++k) {
    const double error = wrap_angle(to[k] - from[k] - turn.rad);
    log_likelihoods_[k] = kept * log_likelihoods_[k] - std::log1p(error * error / scale);
  }
  us_ = us_of(most_probable_s(delays, log_likelihoods_, options));
}

}  // namespace isthmus
