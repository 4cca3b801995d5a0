#pragma once

#include <cstddef>
#include <cstdint>

namespace isthmus {

/// Which stamps are taken, see engine.hpp and lcmtypes/README.md.
struct IntakeOptions {
  std::int64_t odometry_wait_us = 200'000;
  std::int64_t backward_us = 1'000'000;
  std::int64_t teammate_stamp_us = 1'000'000;
  std::size_t max_pending_scans = 64;
  int max_stale_scans = 10;

  template <class Visitor>
  void visit_options(Visitor&& option) {
    option(odometry_wait_us, "odometry_wait_us", "µs", "of event time that a scan waits for its odometry");
    option(backward_us, "backward_us", "µs", "by which stamps of a robot may go back");
    option(
        teammate_stamp_us, "teammate_stamp_us", "µs",
        "between a sighting and the newest odometry: one farther off says nothing of who stands there now");
    option(max_pending_scans, "max_pending_scans", "count",
           "of a robot that wait, however slowly event time passes: 1.6 s at 40 Hz");
    option(max_stale_scans, "max_stale_scans", "count",
           "in a row: then the robot's clock was set back, and a new session begins");
  }
};

}  // namespace isthmus
