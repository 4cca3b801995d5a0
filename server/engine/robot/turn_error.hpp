#pragma once

#include <tuple>

#include "server/engine/input/options/robot_options.hpp"

namespace isthmus {

/// How what odometry tells of turns errs from one scan to the next: where it tells them late, slips, or tells
/// them only up to some rate, much as before. An autoregression of first order whose coefficient is learned
/// on line (Box and Jenkins 1970, "Time series analysis", 3.2). Scans that match tell of turns better than
/// that; where they do not, it goes on from the last that did.
class TurnError {
 public:
  /// Of the next step, by which odometry tells too little of it.
  double expected_rad() const;

  /// One matched step told `error_rad` too small, of which odometry errs with `variance_rad2`.
  void learn(double error_rad, double variance_rad2, const OdometryNoiseOptions& options);

  /// One step that was not matched erred as was expected.
  void go_on() { last_rad_ = expected_rad(); }

  auto members() { return std::tie(last_rad_, products_, squares_); }

 private:
  double last_rad_ = 0;
  double products_ = 0;  // of errors with the ones before, the older the less
  double squares_ = 0;   // of errors, and of what errors at random would come to
};

}  // namespace isthmus
