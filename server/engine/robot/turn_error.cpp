#include "server/engine/robot/turn_error.hpp"

#include <algorithm>

namespace isthmus {

double TurnError::expected_rad() const {
  return squares_ > 0 ? std::clamp(products_ / squares_, 0.0, 1.0) * last_rad_ : 0;
}

void TurnError::learn(double error_rad, double variance_rad2, const OdometryNoiseOptions& options) {
  const double kept = 1 - options.forgetting;
  products_ = kept * products_ + error_rad * last_rad_;
  squares_ = kept * squares_ + last_rad_ * last_rad_ + options.forgetting * variance_rad2;
  last_rad_ = error_rad;
}

}  // namespace isthmus
