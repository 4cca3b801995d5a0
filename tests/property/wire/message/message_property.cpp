#include <gtest/gtest.h>
#include <rapidcheck.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "server/wire/message/message.hpp"

namespace isthmus {
namespace {

using rc::gen::arbitrary;
using rc::gen::inRange;

double uniform(double least, double most) {
  return least + (most - least) * *inRange<std::int32_t>(0, 1'000'001) / 1e6;
}

std::int64_t utime() { return *inRange<std::int64_t>(0, std::int64_t{1} << 53); }
std::int32_t barcode() { return *inRange<std::int32_t>(0, std::numeric_limits<std::int32_t>::max()); }
std::string robot_name() {
  return *rc::gen::element<std::string>("R1", "ROBOT_2", "A-B", "7", "SCAN", "X_ODOMETRY");
}

RobotEvent robot_event() {
  RobotEvent event;
  event.robot = robot_name();
  event.utime = utime();
  event.barcode = *arbitrary<std::int32_t>();
  event.laser.robot_from_laser = {uniform(-100, 100), uniform(-100, 100), uniform(-3, 3)};
  event.laser.range_min_m = uniform(0, 1);
  event.laser.range_max_m = uniform(2, 1e5);
  event.footprint_radius_m = uniform(0, 100);
  event.restarted = *arbitrary<bool>();
  return event;
}

float any_range_m() {
  const float none = std::numeric_limits<float>::infinity();
  return *rc::gen::oneOf(
      rc::gen::element(none, -none, 0.0F, -1.0F),
      rc::gen::map(inRange(0, 100'000), [](int mm) { return static_cast<float>(mm) / 1000; }));
}

ScanEvent scan_event() {
  ScanEvent event{robot_name(), {}};
  event.scan.utime = utime();
  event.scan.bearing0_rad = static_cast<float>(uniform(-6, 6));
  event.scan.ranges_m.resize(static_cast<std::size_t>(*inRange(1, 2000)));
  event.scan.bearing_step_rad = static_cast<float>(uniform(1e-5, 3e-3)) * (*arbitrary<bool>() ? 1 : -1);
  for (float& range_m : event.scan.ranges_m) range_m = any_range_m();
  event.scan.ranges_m.back() = 1;
  return event;
}

SightingEvent sighting_event() {
  SightingEvent event{robot_name(),     utime(),        barcode(),       uniform(0, 100),
                      uniform(1e-3, 1), uniform(-6, 6), uniform(1e-3, 1)};
  if (*arbitrary<bool>()) {
    const bool no_range = *arbitrary<bool>();
    (no_range ? event.range_m : event.bearing_rad) = 0;
    (no_range ? event.range_sigma_m : event.bearing_sigma_rad) = std::numeric_limits<double>::infinity();
  }
  return event;
}

CommandEvent command_event() {
  const bool of_closure = *arbitrary<bool>();
  if (of_closure) {
    return {utime(), *rc::gen::element(Verb::withdraw, Verb::forbid, Verb::allow),
            *rc::gen::inRange<std::int64_t>(0, std::numeric_limits<std::int32_t>::max()),
            *arbitrary<bool>() ? robot_name() : ""};
  }
  return {utime(), *rc::gen::element(Verb::allow, Verb::drop, Verb::refine, Verb::send_map),
          *arbitrary<std::int64_t>(), robot_name()};
}

AnnotationEvent annotation_event() {
  AnnotationEvent event;
  event.utime = utime();
  event.kind = *rc::gen::element(AnnotationKind::place, AnnotationKind::keep_out, AnnotationKind::speed,
                                 AnnotationKind::erase);
  event.name = *rc::gen::element<std::string>("Dock 1", "a", "B-2_c.d", std::string(48, 'x'));
  event.replace = *arbitrary<bool>();
  if (event.kind == AnnotationKind::speed) event.max_speed_m_s = uniform(0.01, 100);
  event.yaw_rad = uniform(-12, 12);
  event.island = IslandId{*inRange<std::int32_t>(-1, 1000)};
  int points = is_zone(event.kind) ? *inRange(3, 65) : 0;
  if (event.kind == AnnotationKind::place) points = 1;
  for (int i = 0; i < points; ++i)
    event.points.push_back(
        {PatchId{*inRange<std::int32_t>(-1, 1000)}, {uniform(-1e6, 1e6), uniform(-1e6, 1e6)}});
  return event;
}

InitialPoseEvent initial_pose_event() {
  InitialPoseEvent event;
  event.robot = robot_name();
  event.utime = utime();
  event.island = IslandId{*inRange<std::int32_t>(-1, 1000)};
  event.patch = PatchId{*inRange<std::int32_t>(-1, 1000)};
  event.pose = {uniform(-1e6, 1e6), uniform(-1e6, 1e6), uniform(-12, 12)};
  event.sigma_m = uniform(1e-3, 10);
  event.sigma_rad = uniform(1e-3, 3.14);
  return event;
}

Event random_event() {
  Event event;
  event.receive_utime = utime();
  switch (*inRange(0, 10)) {
    case 0:
      event.body = robot_event();
      break;
    case 1:
      event.body =
          OdometryEvent{robot_name(), utime(), {uniform(-1e6, 1e6), uniform(-1e3, 1e3), uniform(-3, 3)}};
      break;
    case 2:
      event.body = scan_event();
      break;
    case 3:
      event.body = sighting_event();
      break;
    case 4:
      event.body = TagEvent{utime(), barcode()};
      break;
    case 5:
      event.body = command_event();
      break;
    case 6:
      event.body = ConfigurationEvent{*rc::gen::container<std::string>(inRange<char>(1, 127))};
      break;
    case 7:
      event.body = annotation_event();
      break;
    case 8:
      event.body = initial_pose_event();
      break;
    default:
      event.body = TickEvent{};
  }
  return event;
}

bool same(const Laser& a, const Laser& b) {
  return a.robot_from_laser == b.robot_from_laser && a.range_min_m == b.range_min_m &&
         a.range_max_m == b.range_max_m;
}

/// Equality of what each event says; the heading passes through a quaternion, which costs it its last digits.
struct SameBody {
  const Event& other;

  bool operator()(const RobotEvent& a) const {
    const auto& b = std::get<RobotEvent>(other.body);
    return a.robot == b.robot && a.utime == b.utime && a.barcode == b.barcode && same(a.laser, b.laser) &&
           a.footprint_radius_m == b.footprint_radius_m && a.restarted == b.restarted;
  }
  bool operator()(const OdometryEvent& a) const {
    const auto& b = std::get<OdometryEvent>(other.body);
    return a.robot == b.robot && a.utime == b.utime && a.odom_from_robot.x == b.odom_from_robot.x &&
           a.odom_from_robot.y == b.odom_from_robot.y &&
           std::abs(a.odom_from_robot.yaw - b.odom_from_robot.yaw) < 1e-14;
  }
  bool operator()(const ScanEvent& a) const {
    const auto& b = std::get<ScanEvent>(other.body);
    return a.robot == b.robot && a.scan.utime == b.scan.utime && a.scan.bearing0_rad == b.scan.bearing0_rad &&
           a.scan.bearing_step_rad == b.scan.bearing_step_rad && a.scan.ranges_m == b.scan.ranges_m;
  }
  bool operator()(const SightingEvent& a) const {
    const auto& b = std::get<SightingEvent>(other.body);
    return a.robot == b.robot && a.utime == b.utime && a.barcode == b.barcode && a.range_m == b.range_m &&
           a.range_sigma_m == b.range_sigma_m && a.bearing_rad == b.bearing_rad &&
           a.bearing_sigma_rad == b.bearing_sigma_rad;
  }
  bool operator()(const TagEvent& a) const {
    const auto& b = std::get<TagEvent>(other.body);
    return a.utime == b.utime && a.barcode == b.barcode;
  }
  bool operator()(const CommandEvent& a) const {
    const auto& b = std::get<CommandEvent>(other.body);
    return a.utime == b.utime && a.verb == b.verb && a.closure == b.closure && a.robot == b.robot;
  }
  bool operator()(const AnnotationEvent& a) const {
    const auto& b = std::get<AnnotationEvent>(other.body);
    return a.utime == b.utime && a.kind == b.kind && a.name == b.name && a.replace == b.replace &&
           a.max_speed_m_s == b.max_speed_m_s && a.yaw_rad == b.yaw_rad && a.island == b.island &&
           std::ranges::equal(a.points, b.points, [](const auto& one, const auto& other_point) {
             return one.patch == other_point.patch && one.position == other_point.position;
           });
  }
  bool operator()(const InitialPoseEvent& a) const {
    const auto& b = std::get<InitialPoseEvent>(other.body);
    return a.robot == b.robot && a.utime == b.utime && a.island == b.island && a.patch == b.patch &&
           a.pose == b.pose && a.sigma_m == b.sigma_m && a.sigma_rad == b.sigma_rad;
  }
  bool operator()(const ConfigurationEvent& a) const {
    return a.toml == std::get<ConfigurationEvent>(other.body).toml;
  }
  bool operator()(const TickEvent&) const { return std::holds_alternative<TickEvent>(other.body); }
};

Decoded decode_message(const Message& message) {
  return decode(ChannelNames{}, message.channel, message.bytes, message.utime);
}

TEST(MessageProperty, EveryPlausibleEventComesBackAsItWas) {
  EXPECT_TRUE(rc::check([] {
    const Event event = random_event();
    const Decoded decoded = decode_message(encode(event));
    RC_ASSERT(decoded.reason == DropReason::none);
    RC_ASSERT(decoded.event.has_value());
    RC_ASSERT(decoded.event->receive_utime == event.receive_utime);
    RC_ASSERT(decoded.event->body.index() == event.body.index());
    RC_ASSERT(std::visit(SameBody{event}, decoded.event->body));
  }));
}

// What survives the checks is a valid event: written and read again, it is the same.
TEST(MessageProperty, DamagedBytesAreRefusedOrReadAsAValidEvent) {
  EXPECT_TRUE(rc::check([] {
    Message message = encode(random_event());
    for (int i = *inRange(1, 6); i > 0; --i) {
      const std::size_t at = *inRange<std::size_t>(0, message.bytes.size());
      message.bytes[at] = *arbitrary<std::uint8_t>();
    }
    if (*inRange(0, 4) == 0) message.bytes.resize(*inRange<std::size_t>(0, message.bytes.size() + 10));
    const Decoded decoded = decode_message(message);
    RC_ASSERT(decoded.event.has_value() == (decoded.reason == DropReason::none));
    if (!decoded.event) return;
    const Decoded again = decode_message(encode(*decoded.event));
    RC_ASSERT(again.event.has_value());
    RC_ASSERT(again.event->body.index() == decoded.event->body.index());
  }));
}

TEST(MessageProperty, RandomBytesAreRefused) {
  EXPECT_TRUE(rc::check([](const std::vector<std::uint8_t>& bytes) {
    const auto channel = *rc::gen::element<std::string>(
        "R1_ROBOT", "R1_SCAN", "R1_ODOMETRY", "R1_SIGHTING", "ISTHMUS_TAG", "ISTHMUS_COMMAND",
        "ISTHMUS_CONFIGURATION", "ISTHMUS_ANNOTATION", "R1_INITIAL_POSE");
    RC_ASSERT(!decode(ChannelNames{}, channel, bytes, 0).event);
  }));
}

}  // namespace
}  // namespace isthmus
