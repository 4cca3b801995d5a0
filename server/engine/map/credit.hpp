#pragma once

#include <algorithm>
#include <cstdint>
#include <tuple>

namespace isthmus {

/// How fast credit grows, and how far.
struct CreditRate {
  double share = 0;         ///< of the time that passes
  std::int64_t max_us = 0;  ///< what is not used beyond this is lost
};

/// A budget of nominal time for background work: it grows with the time that passes from event to
/// event, and each bounded step of the work is paid from it. Prices are constants and not measured, so that
/// the same events bring the same steps.
class Credit {
 public:
  /// The time since the last call has passed, but no more than a second of it counts.
  void earn(std::int64_t now_utime, const CreditRate& rate) {
    const std::int64_t passed = std::clamp<std::int64_t>(now_utime - last_utime_, 0, max_passed_us);
    last_utime_ = now_utime;
    left_us_ =
        std::min(rate.max_us, left_us_ + static_cast<std::int64_t>(rate.share * static_cast<double>(passed)));
  }
  /// Pays for a step. What a step costs may be known only after it: credit may become negative.
  void spend(std::int64_t price_us) { left_us_ -= price_us; }
  std::int64_t left_us() const { return left_us_; }

  auto members() { return std::tie(left_us_, last_utime_); }

 private:
  static constexpr std::int64_t max_passed_us = 1'000'000;

  std::int64_t left_us_ = 0;
  std::int64_t last_utime_ = 0;
};

}  // namespace isthmus
