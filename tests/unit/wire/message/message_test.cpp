#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "bot_core/planar_lidar_t.hpp"
#include "bot_core/pose_t.hpp"
#include "isthmus/sighting_t.hpp"
#include "server/wire/message/message.hpp"

namespace isthmus {
namespace {

constexpr double pi = 3.14159265358979323846;
constexpr double infinity = std::numeric_limits<double>::infinity();
constexpr double not_a_number = std::numeric_limits<double>::quiet_NaN();

template <class T>
std::vector<std::uint8_t> bytes_of(const T& message) {
  std::vector<std::uint8_t> bytes(static_cast<std::size_t>(message.getEncodedSize()));
  message.encode(bytes.data(), 0, static_cast<int>(bytes.size()));
  return bytes;
}

Decoded decode_on(const std::string& channel, const std::vector<std::uint8_t>& bytes) {
  return decode(ChannelNames{}, channel, bytes, 1'000'000);
}

bot_core::pose_t plain_pose() {
  bot_core::pose_t pose{};
  pose.utime = 5;
  pose.pos[0] = 1;
  pose.pos[1] = 2;
  pose.orientation[0] = 1;
  return pose;
}

bot_core::planar_lidar_t scan_of(std::vector<float> ranges) {
  bot_core::planar_lidar_t scan{};
  scan.utime = 5;
  scan.nranges = static_cast<std::int32_t>(ranges.size());
  scan.ranges = std::move(ranges);
  scan.nintensities = 0;
  scan.rad0 = -1;
  scan.radstep = 0.1F;
  return scan;
}

RobotEvent plain_robot() {
  RobotEvent robot;
  robot.robot = "R1";
  robot.utime = 5;
  robot.barcode = 7;
  return robot;
}

SightingEvent plain_sighting() { return {"R1", 5, 7, 2.0, 0.1, 0.5, 0.01}; }

Decoded round_trip(const Event& event) {
  const Message message = encode(event);
  return decode(ChannelNames{}, message.channel, message.bytes, message.utime);
}

// Fields equal to the LCM world's own types make the same wire type: old logs and viewers work.
TEST(WireTypes, HaveTheFingerprintsOfBotCore) {
  EXPECT_EQ(static_cast<std::uint64_t>(bot_core::pose_t::getHash()), 0x2e16efb052b0105eULL);
  EXPECT_EQ(static_cast<std::uint64_t>(bot_core::planar_lidar_t::getHash()), 0xe3d17423180b5e8dULL);
}

TEST(Decode, TakesTheRobotFromTheChannelWithoutCase) {
  const Decoded decoded = decode_on("r2_Odometry", bytes_of(plain_pose()));
  ASSERT_TRUE(decoded.event) << word(decoded.reason);
  EXPECT_EQ(decoded.robot, "R2");
  EXPECT_EQ(std::get<OdometryEvent>(decoded.event->body).robot, "R2");
  EXPECT_EQ(decoded.event->receive_utime, 1'000'000);
}

TEST(Decode, LeavesForeignChannelsAlone) {
  for (const char* channel : {"R1_POSE", "ISTHMUS_MAP", "CAMERA", "", "R1_SCANNER"}) {
    const Decoded decoded = decode_on(channel, bytes_of(plain_pose()));
    EXPECT_FALSE(decoded.ours) << channel;
    EXPECT_FALSE(decoded.event) << channel;
  }
}

TEST(Decode, RefusesNamesThatCannotBeFileNames) {
  for (const char* channel : {"../ETC_SCAN", "_SCAN", "A B_SCAN", "ISTHMUS_SCAN", "-X_ROBOT"}) {
    const Decoded decoded = decode_on(channel, bytes_of(scan_of({1, 1})));
    EXPECT_EQ(decoded.reason, DropReason::bad_channel) << channel;
    EXPECT_TRUE(decoded.ours) << channel;
    EXPECT_EQ(decoded.robot, "") << channel;
  }
}

TEST(Decode, ReadsTheChannelsOfTheConfigurationInsteadOfTheDefault) {
  ChannelNames configured;
  configured["R1"].odometry = "POSE_BASE";
  const auto bytes = bytes_of(plain_pose());
  EXPECT_EQ(decode(configured, "POSE_BASE", bytes, 1).robot, "R1");
  EXPECT_FALSE(decode(configured, "pose_base", bytes, 1).ours);
  EXPECT_FALSE(decode(configured, "R1_ODOMETRY", bytes, 1).ours);
  EXPECT_TRUE(decode(configured, "R2_ODOMETRY", bytes, 1).event);
}

TEST(Decode, HeadingIsTheDirectionOfTheRotatedXAxis) {
  bot_core::pose_t pose = plain_pose();
  // A quarter turn about z after a tilt of 30 degrees about x: x points along y all the same.
  const double c = std::cos(pi / 4), s = std::sin(pi / 4), ct = std::cos(pi / 12), st = std::sin(pi / 12);
  const double tilted[4] = {c * ct, c * st, s * st, s * ct};
  std::copy(std::begin(tilted), std::end(tilted), pose.orientation);
  const Decoded decoded = decode_on("R1_ODOMETRY", bytes_of(pose));
  ASSERT_TRUE(decoded.event) << word(decoded.reason);
  EXPECT_NEAR(std::get<OdometryEvent>(decoded.event->body).odom_from_robot.yaw, pi / 2, 1e-12);
}

TEST(Decode, RefusesOdometryThatCannotBe) {
  const auto reason = [](auto change) {
    bot_core::pose_t pose = plain_pose();
    change(pose);
    return decode_on("R1_ODOMETRY", bytes_of(pose)).reason;
  };
  EXPECT_EQ(reason([](auto&) {}), DropReason::none);
  EXPECT_EQ(reason([](auto& pose) { pose.pos[0] = not_a_number; }), DropReason::not_finite);
  EXPECT_EQ(reason([](auto& pose) { pose.pos[1] = -infinity; }), DropReason::not_finite);
  EXPECT_EQ(reason([](auto& pose) { pose.orientation[3] = not_a_number; }), DropReason::not_finite);
  EXPECT_EQ(reason([](auto& pose) { pose.pos[0] = 1e7; }), DropReason::absurd_value);
  EXPECT_EQ(reason([](auto& pose) { pose.orientation[0] = 0; }), DropReason::absurd_value);
  EXPECT_EQ(reason([](auto& pose) { pose.orientation[0] = 1e200; }), DropReason::absurd_value);
  EXPECT_EQ(reason([](auto& pose) { pose.utime = -1; }), DropReason::absurd_value);
  EXPECT_EQ(reason([](auto& pose) { pose.utime = std::numeric_limits<std::int64_t>::max(); }),
            DropReason::absurd_value);
  EXPECT_EQ(reason([](auto& pose) { pose.vel[0] = pose.pos[2] = not_a_number; }), DropReason::none)
      << "not used";
}

TEST(Decode, RefusesScansThatCannotBe) {
  const auto reason = [](const bot_core::planar_lidar_t& scan) {
    return decode_on("R1_SCAN", bytes_of(scan)).reason;
  };
  const auto changed = [](auto change) {
    bot_core::planar_lidar_t scan = scan_of({1, 2, 3});
    change(scan);
    return scan;
  };
  const float nanf = std::numeric_limits<float>::quiet_NaN();
  const float inff = std::numeric_limits<float>::infinity();
  EXPECT_EQ(reason(scan_of({1, 2, 3})), DropReason::none);
  EXPECT_EQ(reason(scan_of({nanf, -inff, 0, inff})), DropReason::none)
      << "beams are judged one by one (REP-117)";
  EXPECT_EQ(reason(scan_of({})), DropReason::zero_beams);
  EXPECT_EQ(reason(scan_of({nanf, -inff})), DropReason::not_finite);
  EXPECT_EQ(reason(scan_of({-1, 0, nanf})), DropReason::absurd_value);
  EXPECT_EQ(reason(scan_of(std::vector<float>(20'001, 1))), DropReason::bad_length);
  EXPECT_EQ(reason(changed([&](auto& scan) { scan.rad0 = nanf; })), DropReason::not_finite);
  EXPECT_EQ(reason(changed([&](auto& scan) { scan.radstep = inff; })), DropReason::not_finite);
  EXPECT_EQ(reason(changed([](auto& scan) { scan.radstep = 0; })), DropReason::absurd_value);
  EXPECT_EQ(reason(changed([](auto& scan) { scan.radstep = 4; })), DropReason::absurd_value);
  EXPECT_EQ(reason(changed([](auto& scan) { scan.rad0 = 1e9F; })), DropReason::absurd_value);
  bot_core::planar_lidar_t one_beam = scan_of({1});
  one_beam.radstep = 0;
  EXPECT_EQ(reason(one_beam), DropReason::none) << "the report says that there is but one";
  EXPECT_EQ(reason(changed([](auto& scan) { scan.radstep = -0.1F; })), DropReason::none);
}

TEST(Decode, RefusesRobotsThatCannotBe) {
  const auto reason = [](auto change) {
    RobotEvent robot = plain_robot();
    change(robot);
    return round_trip({1, robot}).reason;
  };
  EXPECT_EQ(reason([](auto&) {}), DropReason::none);
  EXPECT_EQ(reason([](auto& robot) { robot.laser.robot_from_laser.yaw = not_a_number; }),
            DropReason::not_finite);
  EXPECT_EQ(reason([](auto& robot) { robot.laser.robot_from_laser.x = 1e3; }), DropReason::absurd_value);
  EXPECT_EQ(reason([](auto& robot) { robot.laser.range_max_m = robot.laser.range_min_m; }),
            DropReason::absurd_value);
  EXPECT_EQ(reason([](auto& robot) { robot.laser.range_min_m = -1; }), DropReason::absurd_value);
  EXPECT_EQ(reason([](auto& robot) { robot.laser.range_max_m = -1; }), DropReason::absurd_value);
  EXPECT_EQ(reason([](auto& robot) { robot.footprint_radius_m = -1; }), DropReason::absurd_value);
}

TEST(Decode, TakesAMaximumRangeOfZeroForNoLaserWhateverTheMinimum) {
  for (const double range_min_m : {0.0, 0.05, 20.0}) {
    RobotEvent robot = plain_robot();
    robot.laser.range_min_m = range_min_m;
    robot.laser.range_max_m = 0;
    const Decoded decoded = round_trip({1, robot});
    ASSERT_TRUE(decoded.event) << word(decoded.reason);
    EXPECT_EQ(std::get<RobotEvent>(decoded.event->body).laser.range_max_m, 0);
  }
}

TEST(Decode, RefusesARobotUnderAnotherName) {
  const Message message = encode({1, plain_robot()});
  EXPECT_EQ(decode_on("R1_ROBOT", message.bytes).reason, DropReason::none);
  EXPECT_EQ(decode_on("R2_ROBOT", message.bytes).reason, DropReason::bad_name);
}

TEST(Decode, TakesSightingsWithOnePartNotMeasured) {
  SightingEvent sighting = plain_sighting();
  sighting.range_sigma_m = infinity;
  sighting.range_m = not_a_number;
  const Decoded decoded = round_trip({1, sighting});
  ASSERT_TRUE(decoded.event) << word(decoded.reason);
  EXPECT_EQ(std::get<SightingEvent>(decoded.event->body).range_m, 0);
  EXPECT_EQ(std::get<SightingEvent>(decoded.event->body).bearing_rad, sighting.bearing_rad);
}

TEST(Decode, RefusesSightingsThatCannotBe) {
  const auto reason = [](auto change) {
    SightingEvent sighting = plain_sighting();
    change(sighting);
    return round_trip({1, sighting}).reason;
  };
  EXPECT_EQ(reason([](auto&) {}), DropReason::none);
  EXPECT_EQ(reason([](auto& s) { s.range_sigma_m = s.bearing_sigma_rad = infinity; }),
            DropReason::absurd_value);
  EXPECT_EQ(reason([](auto& s) { s.range_sigma_m = 0; }), DropReason::absurd_value);
  EXPECT_EQ(reason([](auto& s) { s.bearing_sigma_rad = not_a_number; }), DropReason::not_finite);
  EXPECT_EQ(reason([](auto& s) { s.range_m = not_a_number; }), DropReason::not_finite);
  EXPECT_EQ(reason([](auto& s) { s.range_m = -1; }), DropReason::absurd_value);
  EXPECT_EQ(reason([](auto& s) { s.barcode = -1; }), DropReason::absurd_value);
}

TEST(Decode, RefusesUnknownCommands) {
  Message absurd = encode({1, CommandEvent{5, Verb::refine, -1, ""}});
  constexpr std::string_view known = "refine";
  std::ranges::copy(std::string_view("absurd"),
                    std::search(absurd.bytes.begin(), absurd.bytes.end(), known.begin(), known.end()));
  EXPECT_EQ(decode_on(absurd.channel, absurd.bytes).reason, DropReason::unknown_command);
  EXPECT_EQ(round_trip({1, CommandEvent{5, Verb::send_map, -1, ""}}).reason, DropReason::none);
  EXPECT_EQ(round_trip({1, CommandEvent{5, Verb::drop, -1, "r1"}}).reason, DropReason::none);
  EXPECT_EQ(round_trip({1, CommandEvent{5, Verb::drop, -1, "../x"}}).reason, DropReason::bad_name);
}

TEST(Decode, RefusesCommandsThatNameNothing) {
  const auto reason = [](Verb verb, std::int64_t closure, const char* robot) {
    return round_trip({1, CommandEvent{5, verb, closure, robot}}).reason;
  };
  for (const Verb verb : {Verb::withdraw, Verb::forbid, Verb::allow}) {
    EXPECT_EQ(reason(verb, 0, ""), DropReason::none) << word(verb);
    EXPECT_EQ(reason(verb, -1, ""), DropReason::absurd_value) << word(verb);
    EXPECT_EQ(reason(verb, std::int64_t{1} << 31, ""), DropReason::absurd_value) << word(verb);
  }
  EXPECT_EQ(reason(Verb::allow, -1, "R1"), DropReason::none) << "takes back a drop";
  EXPECT_EQ(reason(Verb::drop, -1, ""), DropReason::bad_name);
  EXPECT_EQ(reason(Verb::refine, -1, ""), DropReason::none);
}

AnnotationEvent plain_zone() {
  AnnotationEvent zone;
  zone.utime = 5;
  zone.kind = AnnotationKind::speed;
  zone.name = "Ramp 2";
  zone.replace = true;
  zone.max_speed_m_s = 0.5;
  zone.points = {{PatchId{3}, {0, 1}}, {PatchId{4}, {2, 1.5}}, {PatchId{3}, {-1, 7}}};
  return zone;
}

TEST(Decode, ReadsWhatOperatorsDraw) {
  const Decoded decoded = round_trip({9, plain_zone()});
  ASSERT_TRUE(decoded.event) << word(decoded.reason);
  const auto& zone = std::get<AnnotationEvent>(decoded.event->body);
  EXPECT_EQ(zone.kind, AnnotationKind::speed);
  EXPECT_EQ(zone.name, "Ramp 2");
  EXPECT_TRUE(zone.replace);
  EXPECT_EQ(zone.max_speed_m_s, 0.5);
  EXPECT_FALSE(zone.island.valid());
  ASSERT_EQ(zone.points.size(), 3U);
  EXPECT_EQ(zone.points[1].patch, PatchId{4});
  EXPECT_EQ(zone.points[1].position, Eigen::Vector2d(2, 1.5));
}

TEST(Decode, RefusesDrawingsThatCannotBe) {
  const auto refusal = [](const auto& change) {
    AnnotationEvent zone = plain_zone();
    change(zone);
    return round_trip({9, zone}).reason;
  };
  EXPECT_EQ(refusal([](auto& zone) { zone.points[0].position.x() = not_a_number; }), DropReason::not_finite);
  EXPECT_EQ(refusal([](auto& zone) { zone.max_speed_m_s = not_a_number; }), DropReason::not_finite);
  EXPECT_EQ(refusal([](auto& zone) { zone.points[0].position.x() = 2e6; }), DropReason::absurd_value);
  EXPECT_EQ(refusal([](auto& zone) { zone.points[0].patch = PatchId{-2}; }), DropReason::absurd_value);
  EXPECT_EQ(refusal([](auto& zone) { zone.max_speed_m_s = 0; }), DropReason::absurd_value);
  EXPECT_EQ(refusal([](auto& zone) { zone.kind = AnnotationKind::keep_out; }), DropReason::absurd_value)
      << "with a speed";
  EXPECT_EQ(refusal([](auto& zone) { zone.points.pop_back(); }), DropReason::bad_polygon);
  EXPECT_EQ(refusal([](auto& zone) { zone.points.resize(65); }), DropReason::bad_length);
  EXPECT_EQ(refusal([](auto& zone) { zone.name = "a/b"; }), DropReason::bad_name);
  EXPECT_EQ(refusal([](auto& zone) { zone.kind = AnnotationKind::place; }), DropReason::absurd_value)
      << "of three points";
  annotation_t unknown{};
  unknown.kind = "wall";
  unknown.name = "a";
  EXPECT_EQ(decode_on("ISTHMUS_ANNOTATION", bytes_of(unknown)).reason, DropReason::unknown_command);
}

TEST(Decode, ReadsWhereARobotIsSaidToBe) {
  InitialPoseEvent pose;
  pose.robot = "R1";
  pose.utime = 5;
  pose.patch = PatchId{3};
  pose.pose = {1, 2, 0.5};
  pose.sigma_m = 1;
  pose.sigma_rad = 0.3;
  const Decoded decoded = round_trip({9, pose});
  ASSERT_TRUE(decoded.event);
  const auto& read = std::get<InitialPoseEvent>(decoded.event->body);
  EXPECT_EQ(read.robot, "R1");
  EXPECT_EQ(read.patch, PatchId{3});
  EXPECT_EQ(read.pose, pose.pose);
  EXPECT_EQ(read.sigma_m, 1);
  for (const double sigma : {0.0, -1.0, 11.0}) {
    pose.sigma_m = sigma;
    EXPECT_EQ(round_trip({9, pose}).reason, DropReason::absurd_value) << sigma;
  }
  pose.sigma_m = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(round_trip({9, pose}).reason, DropReason::not_finite);
}

TEST(Decode, RefusesReceiveTimesThatCannotBe) {
  const Message message = encode({1, plain_robot()});
  EXPECT_EQ(decode(ChannelNames{}, message.channel, message.bytes, -1).reason, DropReason::absurd_value);
}

// The generated decoder would read out of bounds, or allocate 1 GB, on these.
TEST(Decode, RefusesCountsThatTheBytesDoNotHold) {
  const std::vector<std::uint8_t> good = bytes_of(scan_of({1, 2, 3}));
  const std::size_t count_at = 8 + 8;
  for (const std::uint32_t count : {0x40000000U, 0x10000000U, 0xFFFFFFFFU, 0x80000000U, 4U, 2U, 20'000U}) {
    std::vector<std::uint8_t> bytes = good;
    for (std::size_t i = 0; i < 4; ++i)
      bytes[count_at + i] = static_cast<std::uint8_t>(count >> (24 - 8 * i));
    EXPECT_FALSE(decode_on("R1_SCAN", bytes).event) << count;
    EXPECT_EQ(decode_on("R1_SCAN", bytes).reason, DropReason::bad_length) << count;
  }
}

TEST(Decode, RefusesStringLengthsThatTheBytesDoNotHold) {
  const std::vector<std::uint8_t> good = encode({1, plain_robot()}).bytes;
  for (const std::uint32_t length : {0U, 0xFFFFFFFFU, 0x80000000U, 2U, 4U, 65U, 0x7FFFFFFFU}) {
    std::vector<std::uint8_t> bytes = good;
    for (std::size_t i = 0; i < 4; ++i) bytes[16 + i] = static_cast<std::uint8_t>(length >> (24 - 8 * i));
    EXPECT_EQ(decode_on("R1_ROBOT", bytes).reason, DropReason::bad_length) << length;
  }
}

// It would not be the same when written again.
TEST(Decode, RefusesTextThatGoesOnAfterANul) {
  std::vector<std::uint8_t> bytes = encode({1, ConfigurationEvent{"abc"}}).bytes;
  EXPECT_EQ(decode_on("ISTHMUS_CONFIGURATION", bytes).reason, DropReason::none);
  bytes[bytes.size() - 3] = 0;
  EXPECT_EQ(decode_on("ISTHMUS_CONFIGURATION", bytes).reason, DropReason::bad_length);
}

TEST(Decode, RefusesAMessageOfAnotherType) {
  EXPECT_EQ(decode_on("R1_SCAN", bytes_of(plain_pose())).reason, DropReason::bad_fingerprint);
  EXPECT_EQ(decode_on("R1_SCAN", {}).reason, DropReason::bad_length);
}

TEST(Decode, RefusesEveryShorterAndLongerMessage) {
  for (const Message& message :
       {encode({1, plain_robot()}), encode({1, plain_sighting()}),
        encode({1, ConfigurationEvent{"tags = \"any\""}}), encode({1, TickEvent{}})}) {
    std::vector<std::uint8_t> bytes = message.bytes;
    bytes.push_back(0);
    EXPECT_EQ(decode_on(message.channel, bytes).reason, DropReason::bad_length) << message.channel;
    for (std::size_t size = 0; size < message.bytes.size(); ++size) {
      bytes.resize(size);
      EXPECT_EQ(decode_on(message.channel, std::vector(bytes)).reason, DropReason::bad_length)
          << message.channel << size;
      bytes = message.bytes;
    }
  }
}

}  // namespace
}  // namespace isthmus
