#include "tools/simulate/campaigns/hostile/unruly_messages.hpp"

#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>

namespace isthmus {
namespace {

template <class Value, std::size_t count>
Value one_of(const std::array<Value, count>& values, Random& random) {
  return values[random.index(count)];
}

/// Nearly always about now: one of another time takes a robot a while to get over.
std::int64_t stamp(std::int64_t utime, Random& random) {
  if (random.chance(0.7)) return utime;
  static constexpr std::array<std::int64_t, 8> off_us = {
      -1, 50'000, -500'000, 150'000, -10'000'000, 3'000'000, -3'600'000'000, 3'600'000'000};
  if (random.chance(0.05)) return random.chance(0.5) ? 0 : std::int64_t{1} << 53;
  return std::max<std::int64_t>(0, utime + one_of(off_us, random));
}

std::int32_t barcode(const Unruly& unruly, Random& random) {
  if (unruly.barcodes.empty() || random.chance(0.2)) return static_cast<std::int32_t>(5000 + random.index(4));
  return unruly.barcodes[random.index(unruly.barcodes.size())];
}

RobotEvent declaration(const Unruly& unruly, std::int64_t utime, Random& random) {
  static constexpr std::array<double, 7> ranges_m = {0, 0, 0.5, 8, 30, 80, 1e5};
  static constexpr std::array<Pose, 4> mounts = {{{}, {0.3, -0.2, 1.5}, {-0.1, 0, 3.1}, {100, -100, 12}}};
  static constexpr std::array<double, 4> radii_m = {0, 0.25, 1, 100};
  RobotEvent event;
  event.robot = unruly.robot;
  event.utime = utime;
  event.laser.range_max_m = one_of(ranges_m, random);
  event.laser.range_min_m = random.chance(0.5) ? 0 : 0.4;
  event.laser.robot_from_laser = one_of(mounts, random);
  event.footprint_radius_m = one_of(radii_m, random);
  event.barcode = random.chance(0.3) ? -1 : barcode(unruly, random);
  event.restarted = random.chance(0.3);
  return event;
}

OdometryEvent odometry(const Unruly& unruly, std::int64_t utime, Random& random) {
  const double reach_m = random.chance(0.8) ? 2 : 1e6;
  return {unruly.robot,
          stamp(utime, random),
          {random.uniform(-reach_m, reach_m), random.uniform(-reach_m, reach_m),
           random.uniform(-std::numbers::pi, std::numbers::pi)}};
}

ScanEvent scan(const Unruly& unruly, std::int64_t utime, Random& random) {
  static constexpr std::array<std::size_t, 6> beams = {1, 2, 11, 90, 361, 5000};
  Scan scan;
  scan.utime = stamp(utime, random);
  scan.ranges_m.resize(one_of(beams, random));
  const double turn_rad = 2 * std::numbers::pi / static_cast<double>(scan.ranges_m.size());
  scan.bearing_step_rad = random.chance(0.5) ? turn_rad : -0.5 * turn_rad;
  scan.bearing0_rad = random.uniform(-std::numbers::pi, std::numbers::pi);
  const double mean_m = random.uniform(0.1, 12);
  for (float& range : scan.ranges_m)
    range = random.chance(0.05) ? std::numeric_limits<float>::quiet_NaN()
                                : static_cast<float>(mean_m * random.uniform(0.9, 1.1));
  scan.ranges_m.front() = static_cast<float>(mean_m);
  return {unruly.robot, std::move(scan)};
}

SightingEvent sighting(const Unruly& unruly, std::int64_t utime, Random& random) {
  const double inf = std::numeric_limits<double>::infinity();
  SightingEvent event;
  event.robot = unruly.robot;
  event.utime = stamp(utime, random);
  event.barcode = barcode(unruly, random);
  event.range_m = random.uniform(0, 8);
  event.bearing_rad = random.uniform(-std::numbers::pi, std::numbers::pi);
  event.range_sigma_m = random.chance(0.1) ? inf : random.uniform(1e-6, 1);
  event.bearing_sigma_rad =
      std::isfinite(event.range_sigma_m) && random.chance(0.1) ? inf : random.uniform(1e-6, 1);
  return event;
}

CommandEvent command(const Unruly& unruly, std::int64_t utime, Random& random) {
  CommandEvent event;
  event.utime = utime;
  const std::string& robot = unruly.robots[random.index(unruly.robots.size())];
  const std::size_t kind = random.index(unruly.closures > 0 ? 8 : 4);
  if (kind == 0 || kind == 1) {
    event.verb = kind == 0 ? Verb::drop : Verb::allow;
    event.robot = robot;
  } else if (kind == 2) {
    event.verb = random.chance(0.05) ? Verb::refine : Verb::send_map;
  } else {
    static constexpr std::array verbs = {Verb::withdraw, Verb::forbid, Verb::allow};
    event.verb = one_of(verbs, random);
    event.closure = kind == 3
                        ? std::int64_t{1'000'000'000}
                        : static_cast<std::int64_t>(random.index(static_cast<std::size_t>(unruly.closures)));
  }
  return event;
}

}  // namespace

Event unruly_event(const Unruly& unruly, std::int64_t utime, Random& random) {
  const double kind = random.uniform();
  if (kind < 0.25) return {utime, declaration(unruly, utime, random)};
  if (kind < 0.6) return {utime, odometry(unruly, utime, random)};
  if (kind < 0.8) return {utime, scan(unruly, utime, random)};
  if (kind < 0.92) return {utime, sighting(unruly, utime, random)};
  if (kind < 0.95) return {utime, TagEvent{utime, barcode(unruly, random)}};
  return {utime, command(unruly, utime, random)};
}

}  // namespace isthmus
