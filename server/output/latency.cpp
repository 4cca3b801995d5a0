#include "server/output/latency.hpp"

#include <algorithm>
#include <cmath>

namespace isthmus {
namespace {

constexpr double smallest_s = 1e-6;
constexpr double growth = 1.02;

/// The middle of a bucket, in the ratio's sense.
double bucket_s(int bucket) { return smallest_s * std::pow(growth, bucket + 0.5); }

}  // namespace

void LatencyHistogram::add(double seconds) {
  if (std::isnan(seconds)) return;
  const double place = std::log(std::max(seconds, smallest_s) / smallest_s) / std::log(growth);
  const int bucket = static_cast<int>(std::min(place, buckets - 1.0));
  ++counts_[static_cast<std::size_t>(bucket)];
  ++count_;
  max_s_ = std::max(max_s_, seconds);
}

double LatencyHistogram::quantile_s(double q) const {
  if (count_ == 0) return 0;
  const double wanted = std::clamp(q, 0.0, 1.0) * static_cast<double>(count_);
  double below = 0;
  for (int bucket = 0; bucket < buckets; ++bucket) {
    below += static_cast<double>(counts_[static_cast<std::size_t>(bucket)]);
    if (below >= wanted && below > 0) return std::min(bucket_s(bucket), max_s_);
  }
  return max_s_;
}

}  // namespace isthmus
