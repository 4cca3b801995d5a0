#include "server/wire/message/message.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "server/wire/message/byte_check.hpp"
#include "server/wire/message/channel.hpp"
#include "server/wire/message/encoded.hpp"
#include "server/wire/message/limits.hpp"
#include "server/wire/message/members.hpp"
#include "server/wire/message/read_message.hpp"

namespace isthmus {
namespace {

constexpr std::int32_t max_toml_bytes = 64 * 1024;

constexpr Member boolean = fixed(1);
constexpr Member floats = array(4, max_beams);

constexpr std::array robot_members = {members::number, members::name,   members::integer, members::number,
                                      members::number, members::number, members::number,  members::number,
                                      members::number, boolean};
constexpr std::array pose_members = {members::number, fixed(3 * 8), fixed(3 * 8),
                                     fixed(4 * 8),    fixed(3 * 8), fixed(3 * 8)};
constexpr std::array lidar_members = {members::number, floats, floats, members::integer, members::integer};
constexpr std::array sighting_members = {members::number, members::integer, members::number,
                                         members::number, members::number,  members::number};
constexpr std::array tag_members = {members::number, members::integer};
constexpr std::array command_members = {members::number, members::name, members::number, members::name};
constexpr std::array configuration_members = {members::number, text(max_toml_bytes)};
constexpr std::array tick_members = {members::number};
constexpr std::array annotation_point_members = {members::integer, members::number, members::number};
constexpr std::array annotation_members = {
    members::number, members::name,
    members::name,   boolean,
    members::number, members::integer,
    members::number, list(annotation_point_members, max_annotation_points)};
constexpr std::array initial_pose_members = {members::number, members::integer, members::integer,
                                             fixed(3 * 8),    members::number,  members::number};

/// How one input lies on the wire, and how it is read.
struct InputType {
  std::int64_t (*fingerprint)();
  std::span<const Member> members;
  Reading (*read)(std::span<const std::uint8_t> bytes, const std::string& robot);
};

/// The generated decoder; the bytes must have been checked.
template <class T>
Reading read_as(std::span<const std::uint8_t> bytes, const std::string& robot) {
  T message;
  const int size = static_cast<int>(bytes.size());
  if (message.decode(bytes.data(), 0, size) != size) return {std::nullopt, DropReason::bad_length};
  return read_message(message, robot);
}

template <class T>
constexpr InputType input_type(std::span<const Member> members) {
  return {&T::getHash, members, &read_as<T>};
}

/// By Input, in its order.
constexpr std::array<InputType, 10> input_types = {
    input_type<robot_t>(robot_members),
    input_type<bot_core::pose_t>(pose_members),
    input_type<bot_core::planar_lidar_t>(lidar_members),
    input_type<sighting_t>(sighting_members),
    input_type<tag_t>(tag_members),
    input_type<command_t>(command_members),
    input_type<configuration_t>(configuration_members),
    input_type<tick_t>(tick_members),
    input_type<annotation_t>(annotation_members),
    input_type<initial_pose_t>(initial_pose_members),
};

template <class T>
Message pack(Input input, const std::string& robot, std::int64_t receive_utime, const T& message) {
  return {receive_utime, default_channel(input, robot), encoded(message)};
}

/// Nothing where the bytes are not safe to decode.
template <class T>
std::optional<T> read_checked(std::span<const Member> members, std::span<const std::uint8_t> bytes) {
  if (check_bytes(T::getHash(), members, bytes) != DropReason::none) return std::nullopt;
  T message;
  const int size = static_cast<int>(bytes.size());
  if (message.decode(bytes.data(), 0, size) != size) return std::nullopt;
  return message;
}

/// Writes each kind of event as the message that `decode` reads.
struct Encoder {
  std::int64_t receive_utime;

  Message operator()(const RobotEvent& event) const {
    robot_t message{};
    message.utime = event.utime;
    message.name = event.robot;
    message.barcode = event.barcode;
    message.laser_x_m = event.laser.robot_from_laser.x;
    message.laser_y_m = event.laser.robot_from_laser.y;
    message.laser_yaw_rad = event.laser.robot_from_laser.yaw;
    message.range_min_m = event.laser.range_min_m;
    message.range_max_m = event.laser.range_max_m;
    message.footprint_radius_m = event.footprint_radius_m;
    message.restarted = event.restarted ? 1 : 0;
    return pack(Input::robot, event.robot, receive_utime, message);
  }

  Message operator()(const OdometryEvent& event) const {
    bot_core::pose_t message{};
    message.utime = event.utime;
    message.pos[0] = event.odom_from_robot.x;
    message.pos[1] = event.odom_from_robot.y;
    message.orientation[0] = std::cos(event.odom_from_robot.yaw / 2);
    message.orientation[3] = std::sin(event.odom_from_robot.yaw / 2);
    return pack(Input::odometry, event.robot, receive_utime, message);
  }

  Message operator()(const ScanEvent& event) const {
    bot_core::planar_lidar_t message{};
    message.utime = event.scan.utime;
    message.nranges = static_cast<std::int32_t>(event.scan.ranges_m.size());
    message.ranges = event.scan.ranges_m;
    message.nintensities = 0;
    message.rad0 = static_cast<float>(event.scan.bearing0_rad);
    message.radstep = static_cast<float>(event.scan.bearing_step_rad);
    return pack(Input::scan, event.robot, receive_utime, message);
  }

  Message operator()(const SightingEvent& event) const {
    sighting_t message{};
    message.utime = event.utime;
    message.barcode = event.barcode;
    message.range_m = event.range_m;
    message.range_sigma_m = event.range_sigma_m;
    message.bearing_rad = event.bearing_rad;
    message.bearing_sigma_rad = event.bearing_sigma_rad;
    return pack(Input::sighting, event.robot, receive_utime, message);
  }

  Message operator()(const TagEvent& event) const {
    tag_t message{};
    message.utime = event.utime;
    message.barcode = event.barcode;
    return pack(Input::tag, "", receive_utime, message);
  }

  Message operator()(const CommandEvent& event) const {
    command_t message{};
    message.utime = event.utime;
    message.verb = word(event.verb);
    message.closure = event.closure;
    message.robot = event.robot;
    return pack(Input::command, "", receive_utime, message);
  }

  Message operator()(const AnnotationEvent& event) const {
    annotation_t message{};
    message.utime = event.utime;
    message.kind = word(event.kind);
    message.name = event.name;
    message.replace = event.replace ? 1 : 0;
    message.max_speed = event.max_speed_m_s;
    message.island = event.island.value;
    message.yaw = event.yaw_rad;
    for (const AnnotationEvent::Point& point : event.points) {
      annotation_point_t one{};
      one.patch = point.patch.value;
      one.x = point.position.x();
      one.y = point.position.y();
      message.points.push_back(one);
    }
    message.npoints = static_cast<std::int32_t>(message.points.size());
    return pack(Input::annotation, "", receive_utime, message);
  }

  Message operator()(const InitialPoseEvent& event) const {
    initial_pose_t message{};
    message.utime = event.utime;
    message.island = event.island.value;
    message.patch = event.patch.value;
    message.pose[0] = event.pose.x;
    message.pose[1] = event.pose.y;
    message.pose[2] = event.pose.yaw;
    message.sigma_m = event.sigma_m;
    message.sigma_rad = event.sigma_rad;
    return pack(Input::initial_pose, event.robot, receive_utime, message);
  }

  Message operator()(const ConfigurationEvent& event) const {
    configuration_t message{};
    message.utime = receive_utime;
    message.toml = event.toml;
    return pack(Input::configuration, "", receive_utime, message);
  }

  Message operator()(const TickEvent&) const {
    tick_t message{};
    message.utime = receive_utime;
    return pack(Input::tick, "", receive_utime, message);
  }
};

}  // namespace

Decoded decode(const ChannelNames& configured, const std::string& channel,
               std::span<const std::uint8_t> bytes, std::int64_t receive_utime) {
  Decoded decoded;
  const std::optional<Channel> found = find_channel(configured, channel);
  if (!found) {
    decoded.ours = false;
    return decoded;
  }
  decoded.robot = found->robot;
  const InputType& type = input_types[static_cast<std::size_t>(found->input)];
  decoded.reason =
      found->valid ? check_bytes(type.fingerprint(), type.members, bytes) : DropReason::bad_channel;
  if (decoded.reason != DropReason::none) return decoded;
  Reading reading = type.read(bytes, found->robot);
  decoded.reason = is_plausible_utime(receive_utime) ? reading.reason : DropReason::absurd_value;
  if (decoded.reason == DropReason::none) decoded.event = Event{receive_utime, std::move(*reading.body)};
  return decoded;
}

std::optional<command_t> read_order(std::span<const std::uint8_t> bytes) {
  return read_checked<command_t>(command_members, bytes);
}

std::optional<annotation_t> read_annotation(std::span<const std::uint8_t> bytes) {
  return read_checked<annotation_t>(annotation_members, bytes);
}

std::optional<initial_pose_t> read_initial_pose(std::span<const std::uint8_t> bytes) {
  return read_checked<initial_pose_t>(initial_pose_members, bytes);
}

bool may_be_input(std::span<const std::uint8_t> beginning, std::int64_t bytes) {
  return std::any_of(input_types.begin(), input_types.end(), [&](const InputType& type) {
    return may_begin(type.fingerprint(), type.members, beginning, bytes);
  });
}

Message encode(const Event& event) { return std::visit(Encoder{event.receive_utime}, event.body); }

}  // namespace isthmus
