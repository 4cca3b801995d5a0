#pragma once

#include <array>
#include <chrono>
#include <cstdint>

namespace isthmus {

/// For reports and the log.
inline double seconds_of(std::chrono::steady_clock::duration duration) {
  return std::chrono::duration<double>(duration).count();
}

/// Event latencies in constant memory: logarithmic buckets of 2 % width from 1 µs to 1000 s, and the exact
/// maximum.
class LatencyHistogram {
 public:
  void add(double seconds);
  std::int64_t count() const { return count_; }
  /// The latency below which a share q of all lie, to 2 %; 0 when there are none.
  double quantile_s(double q) const;
  double max_s() const { return max_s_; }

 private:
  static constexpr int buckets = 1050;
  std::array<std::int64_t, buckets> counts_{};
  std::int64_t count_ = 0;
  double max_s_ = 0;
};

}  // namespace isthmus
